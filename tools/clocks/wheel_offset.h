#pragma once
// How far the stamps of a recording's wheels and frames are apart, from the turns that both show:
// seconds, or the whole distance between an uptime and wall time.

#include <filesystem>
#include <string>

#include "platform/base/result.h"
#include "platform/recording/recording.h"
#include "slam/parameters.h"
#include "tools/calibrate/setup_fit.h"

namespace zenith::tools {

struct WheelOffset {
  bool sure = false;
  double late_s = 0.0;     // the wheels' stamps, against the frames'
  double explained = 0.0;  // of the turning that is seen, with it
  double gain = 0.0;       // rest of the turns without by with it
};

// Reads all of `source`. Offsets up to 0.4 of its length, at most a minute, are looked for.
Result<WheelOffset> measure_wheel_offset(Source& source, const Parameters& parameters);

// The same of a recording's folder whose wheels and frames may have no time in common; then from
// where both begin together.
Result<WheelOffset> measure_wheel_offset(const std::filesystem::path& folder, ReadOptions reading,
                                         const Parameters& parameters);

// "anna: the wheels' stamps are 2.340 s late ..., --wheels-late anna=2.340"
std::string wheel_offset_text(const std::string& robot, const WheelOffset& offset);

}  // namespace zenith::tools
