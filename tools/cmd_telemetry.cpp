// zenith telemetry: what the daemon tells, as lines.

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "platform/base/printable.h"
#include "platform/linux/clock.h"
#include "tools/commands.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Prints what zenithd tells on its telemetry socket: a JSON object a line, described in
docs/daemon.md. `zenith view ssh:HOST` runs this on the robot. A line "picture" on its standard
input asks for pictures during the next three seconds.

Examples:
  zenith telemetry
  zenith telemetry /run/zenith/telemetry.sock | grep health)";

// "picture", and the end. False at the end.
bool take_request(TelemetryLink& link) {
  std::array<char, 256> text;
  const ssize_t size = ::read(STDIN_FILENO, text.data(), text.size());
  if (size > 0 && std::string_view(text.data(), static_cast<std::size_t>(size)).find("picture") !=
                      std::string_view::npos) {
    link.ask_picture();
  }
  return size > 0;
}

// JSON holds no control character but as an escape.
bool may_be_json(std::string_view line) {
  while (!line.empty()) {
    const Utf8Character character = first_character(line);
    if (!character.valid || character.code < 0x20 || character.code == 0x7F) return false;
    line.remove_prefix(character.size);
  }
  return true;
}

// Lines as they come, without what would steer a terminal: escapes of JSON in its place.
class Printer {
 public:
  Printer() = default;
  Printer(const Printer&) = delete;
  Printer& operator=(const Printer&) = delete;
  ~Printer() {
    if (refused_ > 0) std::fprintf(stderr, "%llu lines that are no JSON were left out\n", refused_);
  }

  void print(std::string_view line) {
    if (!may_be_json(line)) {
      ++refused_;
      return;
    }
    const std::string shown = printable(line) + "\n";
    std::fwrite(shown.data(), 1, shown.size(), stdout);
  }

 private:
  unsigned long long refused_ = 0;
};

int run_telemetry(const std::string& socket) {
  auto address = parse_robot_address(socket);
  if (!address.ok()) return fail(address.error());
  TelemetryLink link(std::move(*address));
  Printer printer;
  bool listens = true;
  bool begun = false;
  while (true) {
    link.turn(monotonic_now(), [&printer](std::string_view line) { printer.print(line); });
    begun = begun || link.up();
    if (std::fflush(stdout) != 0) return 0;  // nobody reads any more
    if (link.fd() < 0) {
      if (begun) return 0;
      return fail({link.why() + "; is zenithd running?"});
    }
    std::array<pollfd, 3> entries = {
        {{link.fd(), POLLIN, 0}, {listens ? STDIN_FILENO : -1, POLLIN, 0}, {STDOUT_FILENO, 0, 0}}};
    if (::poll(entries.data(), entries.size(), -1) < 0) return 0;
    if ((entries[2].revents & POLLERR) != 0) return 0;
    if (entries[1].revents != 0) listens = take_request(link);
  }
}

}  // namespace

void add_telemetry_command(CLI::App& app, int& exit_code) {
  const auto socket = std::make_shared<std::string>();
  CLI::App* telemetry = app.add_subcommand("telemetry", "Print what the daemon tells");
  telemetry->footer(kHelp);
  telemetry->add_option("SOCKET", *socket,
                        "the daemon's telemetry.socket; without it the usual places are looked "
                        "through");
  telemetry->callback([socket, &exit_code] { exit_code = run_telemetry(*socket); });
}

}  // namespace zenith::tools
