// Any text as a recording's sensor.yaml.

#include <cmath>
#include <cstdint>
#include <string>

#include "platform/recording/sensor_file.h"
#include "tests/fuzz/require.h"

namespace {

void read_sensor(const std::string& text) {
  const auto sensor = zenith::parse_sensor_file(text, "sensor.yaml");
  if (!sensor) {
    require(sensor.error().message.starts_with("sensor.yaml"));
    return;
  }
  require(sensor->lens.width_px >= 16 && sensor->lens.width_px <= 8192);
  require(sensor->lens.height_px >= 16 && sensor->lens.height_px <= 8192);
  for (const double value :
       {sensor->lens.fu_px, sensor->lens.fv_px, sensor->lens.cu_px, sensor->lens.cv_px,
        sensor->mount.x_m, sensor->mount.y_m, sensor->mount.z_m, sensor->mount.roll_rad,
        sensor->mount.pitch_rad, sensor->mount.yaw_rad, sensor->frame_rate_hz}) {
    require(std::isfinite(value));
  }
  for (const double k : sensor->lens.k) require(std::isfinite(k));
  // What is written of it is YAML again.
  const auto again = zenith::parse_sensor_file(zenith::format_sensor_file(*sensor), "sensor.yaml");
  require(again.ok() || again.error().message.find("bad") == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read_sensor(text);
  return 0;
}
