#include "tools/doctor/check_config.h"

#include <sstream>

namespace zenith::tools {

Findings check_config(const std::filesystem::path& file, std::optional<DaemonConfig>& config,
                      const std::filesystem::path& usual) {
  const std::string what = "configuration";
  std::error_code code;
  const bool is_usual = file.empty();
  if (is_usual && !std::filesystem::exists(usual, code)) {
    config = DaemonConfig();
    return {warn(what, "no --config, and no " + usual.string() + ": checking with defaults",
                 "name the daemon's file with --config", "zenithd --print-config > zenith.toml")};
  }
  const std::filesystem::path& path = is_usual ? usual : file;
  auto read = read_daemon_config(path);
  if (read) {
    config = std::move(*read);
    return {ok(what, path.string() + ", robot " + config->name)};
  }
  Findings findings;
  std::istringstream lines(read.error().message);
  for (std::string line; std::getline(lines, line);) {
    findings.push_back(fail(what, line, "correct it; docs/configuration.md has every key"));
  }
  return findings;
}

}  // namespace zenith::tools
