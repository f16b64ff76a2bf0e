#include "platform/daemon/config_text.h"

#include <array>
#include <string_view>

#include "platform/daemon/config.h"

namespace zenith {
namespace {

struct SectionText {
  std::string_view section;
  std::string_view text;  // lines of at most 90 characters
};

constexpr std::array kSections = {
    SectionText{"robot", "The robot itself."},
    SectionText{"camera", "Where frames come from."},
    SectionText{
        "lens",
        "The lens, in the model of its calibration: docs/calibration.md has the table of models.\n"
        "Equidistant is Kalibr's \"equi\" and OpenCV's \"fisheye\": u = fu theta_d x / r + cu,\n"
        "theta_d = theta (1 + k1 theta^2 + k2 theta^4 + ..). Keys of other models stay as they "
        "are.\n"
        "These are an example's: calibrate yours."},
    SectionText{"mount",
                "Where the camera sits: in base_link, that lies on the floor between the wheels."},
    SectionText{"wheels",
                "Differential drive. The map's scale is that of the wheels: measure them."},
    SectionText{"odometry", "How the base tells the travel of its wheels."},
    SectionText{"odometry.odrive", "For codec = \"odrive\"."},
    SectionText{"odometry.vesc", "For codec = \"vesc\"."},
    SectionText{"odometry.canopen", "For codec = \"canopen\"."},
    SectionText{"odometry.dbc", "For codec = \"dbc\": any base whose wheels stand in a DBC file."},
    SectionText{
        "realtime",
        "What is asked of the kernel. What it does not grant is told once, and done without."},
    SectionText{"load",
                "What happens when the computer is too slow: fewer corners for each frame."},
    SectionText{"telemetry", "A local socket with lines of JSON: docs/daemon.md."},
    SectionText{"record", "`zenith record` of the running robot: docs/recording.md."},
    SectionText{"radio", "Other robots: docs/protocol.md. All that share a key build one map."},
    SectionText{
        "leds",
        "What the robot's lights show: docs/lights.md; how to name them: drivers/leds/README.md."},
    SectionText{"log", "Lines on the standard error output, for journald or a person."},
    SectionText{"slam",
                "The algorithm: docs/algorithm.md. `zenith --parameters` lists the same, `--set` "
                "changes them there."},
    SectionText{"simulation", "For camera.driver and odometry.driver = \"simulated\"."},
    SectionText{
        "replay",
        "For camera.driver and odometry.driver = \"replay\": zenithd-sim alone. Lens, mount, "
        "wheels and\ncodec are the recording's."},
};

std::string_view text_of(const std::string& section) {
  for (const SectionText& known : kSections) {
    if (known.section == section) return known.text;
  }
  return {};
}

void add_comment(std::string& to, std::string_view text) {
  constexpr std::size_t kWidth = 96;
  while (!text.empty()) {
    std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.size() > kWidth) {
      end = line.rfind(' ', kWidth);
      line = text.substr(0, end);
    }
    to += "# " + std::string(line) + "\n";
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

// "true travel by ...; m, 0.1 .. 5"
std::string explanation(const Setting& setting) {
  std::string text = setting.text;
  const std::string range = range_text(setting);
  if (!setting.unit.empty() || !range.empty()) text += "; ";
  text += setting.unit;
  if (!setting.unit.empty() && !range.empty()) text += ", ";
  text += (std::holds_alternative<Choice>(setting.at) ? "one of " : "") + range;
  if (setting.live) text += "; may change while zenithd runs";
  return text;
}

}  // namespace

std::string annotated_config() {
  std::string text =
      "# The configuration of zenithd: every key with its default. Keys that are left out keep "
      "it.\n"
      "# Made by `zenithd --print-config`; checked by `zenithd --check --config FILE`.\n"
      "# After a change: systemctl reload zenithd, for keys that may change while it runs;\n"
      "# systemctl restart zenithd for all others.\n";
  DaemonConfig defaults;
  std::string current;
  for (const Setting& setting : daemon_settings(defaults)) {
    const auto [section, key] = split_key(setting.key);
    if (section != current) {
      text += "\n";
      add_comment(text, text_of(section));
      text += "[" + section + "]\n";
    }
    current = section;
    add_comment(text, explanation(setting));
    text += key + " = " + toml_value(setting) + "\n";
  }
  return text;
}

std::string config_reference() {
  std::string text =
      "# Configuration of zenithd\n"
      "\n"
      "Every key of `zenith.toml`, made of the program's own list (`zenithd --print-reference`).\n"
      "[config/zenith.toml](../config/zenith.toml) is the same as a file to start from. Keys that "
      "are\n"
      "left out keep their defaults. Unknown keys and values out of range are errors, told all at\n"
      "once, each with its line: `zenithd --check --config FILE`.\n"
      "\n"
      "**live**: `systemctl reload zenithd` (SIGHUP) takes it over; all others need a restart. A "
      "file\n"
      "with a mistake leaves everything as it was, and the log says what is wrong with it.\n";
  DaemonConfig defaults;
  std::string current;
  for (const Setting& setting : daemon_settings(defaults)) {
    const auto [section, key] = split_key(setting.key);
    if (section != current) {
      text += "\n## [" + section + "]\n\n" + std::string(text_of(section)) +
              "\n\n| key | default | range | unit | | |\n|---|---|---|---|---|---|\n";
    }
    current = section;
    text += "| `" + key + "` | `" + toml_value(setting) + "` | " + range_text(setting) + " | " +
            setting.unit + " | " + setting.text + " | " + (setting.live ? "live" : "") + " |\n";
  }
  return text;
}

}  // namespace zenith
