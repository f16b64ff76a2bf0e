#include "platform/config/robot_settings.h"

#include <cstdio>
#include <type_traits>

#include "platform/base/printable.h"
#include "slam/image/view.h"

namespace zenith {
namespace {

// In the order of WheelCodecKind.
constexpr WheelCodecKind kCodecs[] = {WheelCodecKind::kAgilexV2, WheelCodecKind::kOdrive,
                                      WheelCodecKind::kVesc, WheelCodecKind::kCanopen,
                                      WheelCodecKind::kDbc};

}  // namespace

Settings wheel_settings(Wheels& wheels) {
  return {
      {"wheels.track_width_m", "m", 0.02, 5.0, "distance of the wheels' tracks",
       &wheels.track_width_m},
      {"wheels.left_scale", "", 0.1, 10.0, "true travel by the travel that the base reports",
       &wheels.left_scale},
      {"wheels.right_scale", "", 0.1, 10.0, "the same of the right wheel", &wheels.right_scale},
  };
}

Setting odometry_setting(const WheelCodecField& field, WheelCodecConfig& config) {
  Setting setting;
  setting.key = "odometry." + std::string(field.key);
  setting.unit = std::string(field.unit);
  setting.min = field.min;
  setting.max = field.max;
  setting.text = std::string(field.text);
  std::visit(
      [&](const auto at) {
        auto* value = at(config);
        if constexpr (std::is_same_v<decltype(value), WheelQuantity*>) {
          setting.at =
              choice_of(*value, {std::string(wheel_quantity_name(WheelQuantity::kPosition)),
                                 std::string(wheel_quantity_name(WheelQuantity::kVelocity))});
        } else {
          setting.at = value;
        }
      },
      field.at);
  return setting;
}

Settings odometry_settings(WheelCodecConfig& config) {
  std::vector<std::string> codecs;
  for (const WheelCodecKind kind : kCodecs) codecs.emplace_back(wheel_codec_name(kind));
  Settings settings = {{"odometry.codec", "", 0, 0, "how the base speaks on the CAN bus",
                        choice_of(config.kind, std::move(codecs))}};
  for (const WheelCodecField& field : wheel_codec_fields()) {
    settings.push_back(odometry_setting(field, config));
  }
  return settings;
}

bool is_interface_name(const std::string& name) {
  constexpr std::size_t kMostBytes = 15;  // IFNAMSIZ with its zero
  return !name.empty() && name.size() <= kMostBytes && name != "." && name != ".." &&
         name.find_first_of("/: ") == std::string::npos && is_printable(name);
}

std::string view_text(const Parameters& parameters, const RobotConfig& robot) {
  const View view = view_of(parameters, robot);
  char text[160];
  std::snprintf(
      text, sizeof text, "%.4g degrees from side to side%s; %.0f %% of it lie in the lens's image",
      view.fov_deg, parameters.rectified_fov_deg == kFittedView ? ", fitted to the lens" : "",
      100.0 * view.inside_share);
  return text;
}

Settings slam_settings(Parameters& parameters) {
  Settings settings;
  for (const ParameterInfo& info : parameter_table()) {
    Setting setting;
    setting.key = "slam." + std::string(info.key);
    setting.unit = std::string(info.unit);
    setting.min = info.min;
    setting.max = info.max;
    setting.text = std::string(info.text);
    std::visit([&](auto field) { setting.at = &(parameters.*field); }, info.field);
    if (auto* const* number = std::get_if<double*>(&setting.at); number && info.may_be_auto) {
      setting.at = AutoNumber{*number};
    }
    settings.push_back(std::move(setting));
  }
  return settings;
}

}  // namespace zenith
