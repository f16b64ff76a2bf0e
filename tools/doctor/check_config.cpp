#include "tools/doctor/check_config.h"

#include <sstream>

#include "platform/config/lens_settings.h"
#include "platform/config/robot_settings.h"
#include "slam/image/view.h"

namespace zenith::tools {
namespace {

// Less of the rectified image than this, and there are few corners to map by.
constexpr double kLeastShare = 0.4;
constexpr double kLeastView_deg = 60.0;

// What of the ceiling the robot maps by.
void check_view(const DaemonConfig& config, Findings& findings) {
  // Played cameras bring their own lens.
  if (config.camera_driver == CameraDriver::kSimulated ||
      config.camera_driver == CameraDriver::kReplay) {
    return;
  }
  const RobotConfig robot = config.robot();
  if (const std::string note = lens_note(robot.lens); !note.empty()) {
    findings.push_back(
        warn("lens", note, "calibrate with views nearer to the rim", "zenith calibrate lens"));
  }
  const View view = view_of(config.slam, robot);
  const std::string text = view_text(config.slam, robot);
  if (view.inside_share < kLeastShare) {
    findings.push_back(warn("view", text,
                            "check lens and mount: the camera leans, or the field is too wide for "
                            "the lens; slam.rectified_fov_deg = \"auto\" fits it"));
  } else if (view.fov_deg < kLeastView_deg) {
    findings.push_back(
        warn("view", text, "a wider lens sees more of the ceiling, and the map needs it"));
  } else {
    findings.push_back(ok("view", text));
  }
}

}  // namespace

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
    Findings findings = {ok(what, path.string() + ", robot " + config->name)};
    check_view(*config, findings);
    return findings;
  }
  Findings findings;
  std::istringstream lines(read.error().message);
  for (std::string line; std::getline(lines, line);) {
    findings.push_back(fail(what, line, "correct it; docs/configuration.md has every key"));
  }
  return findings;
}

}  // namespace zenith::tools
