#include "platform/recording/odometry_section.h"

#include "platform/config/robot_settings.h"

namespace zenith {

std::string format_odometry(WheelCodecConfig config) {
  WheelCodecConfig defaults;
  std::string text;
  std::string current = "odometry";
  for (const WheelCodecField& field : wheel_codec_fields()) {
    if (!field.belongs_to(config.kind)) continue;
    const Setting setting = odometry_setting(field, config);
    const auto [section, key] = split_key(setting.key);
    const std::string value = toml_value(setting);
    const bool is_default = value == toml_value(odometry_setting(field, defaults));
    if (section == "odometry" && is_default) continue;
    if (section != current) text += "\n[" + section + "]\n";
    current = section;
    text += key + " = " + value + "   # " + setting.text + "\n";
  }
  return text;
}

}  // namespace zenith
