#include "tools/calibrate/result_files.h"

#include <cstdio>

#include "platform/recording/layout.h"
#include "platform/recording/sensor_file.h"
#include "tools/atomic_output.h"
#include "tools/calibrate/edit_toml.h"

namespace zenith::tools {

bool is_recording(const std::filesystem::path& path) {
  std::error_code code;
  return std::filesystem::is_directory(path, code) &&
         std::filesystem::exists(layout::robot(path), code);
}

std::string toml_number(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

Status write_sensor_file(const std::filesystem::path& path, const Lens& lens) {
  SensorFile sensor;
  std::error_code code;
  if (std::filesystem::exists(path, code)) {
    const auto old = read_sensor_file(path);
    if (!old) return old.error();
    sensor = *old;
  }
  sensor.lens = lens;
  return write_file(path, format_sensor_file(sensor));
}

Status write_lens(const std::filesystem::path& path, const Lens& lens) {
  if (is_recording(path)) return write_sensor_file(layout::sensor(path), lens);
  TomlValues values = {{"lens.width_px", std::to_string(lens.width_px)},
                       {"lens.height_px", std::to_string(lens.height_px)},
                       {"lens.fu_px", toml_number(lens.fu_px, 4)},
                       {"lens.fv_px", toml_number(lens.fv_px, 4)},
                       {"lens.cu_px", toml_number(lens.cu_px, 4)},
                       {"lens.cv_px", toml_number(lens.cv_px, 4)}};
  for (std::size_t i = 0; i < 4; ++i) {
    values.emplace_back("lens.k" + std::to_string(i + 1), toml_number(lens.k[i], 8));
  }
  return edit_toml_file(path, values);
}

}  // namespace zenith::tools
