#pragma once
// odometry.csv: the total travel of each wheel, in metres.
//
//   stamp,left_m,right_m            optional; names the columns, in any order, others beside them
//   # a comment
//   1436509052.249713,0.0315,0.0302
//
// Commas, semicolons, tabs or blanks. Stamps are seconds with up to nine decimals, or nanoseconds
// when their column's name ends with _ns or [ns]. Travel counts from anywhere and falls when the
// wheel turns backward.

#include <cstddef>
#include <filesystem>

#include "drivers/odometry/wheel_codec_config.h"
#include "platform/base/result.h"
#include "platform/linux/input_file.h"
#include "platform/recording/wheel_log.h"

namespace zenith {

inline constexpr std::size_t kMaxTravelLines = 20'000'000;  // as many as frames of a CAN log

// Lines that are malformed are counted, with the first one's place; so are steps that no wheel can
// make and stamps that do not rise (wheel_decoder.h). Of `config` those keys are used that are no
// codec's own. An error: columns that cannot be told apart, units other than those above, a file
// without any sample.
Result<WheelLog> parse_travel_file(InputLines& lines, const WheelCodecConfig& config);
Result<WheelLog> read_travel_file(const std::filesystem::path& path,
                                  const WheelCodecConfig& config);

// A decoder of readings that are metres of travel already.
WheelDecoder travel_decoder(const WheelCodecConfig& config);

}  // namespace zenith
