#pragma once
// Lenses that other programs calibrated, as their files have them: Kalibr, ROS, OpenCV, Basalt,
// camodocal (VINS), ORB-SLAM, OCamCalib, and what is written like them. docs/calibration.md lists
// them.
//
// Each camera of a file becomes a Lens in its own model, without fitting: the same formula, the
// same numbers. What Lens cannot express is no Lens but a reason, of that camera alone.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "slam/image/lens.h"

namespace zenith::tools {

// What coefficients mean that a file does not name the model of. A file's own word counts unless a
// person says otherwise.
enum class ForeignModel : std::uint8_t { kAsTheFileSays, kPinhole, kFisheye };

struct ForeignLens {
  std::string format;    // "Kalibr", ...
  std::string camera;    // its name in the file; may be empty when there is only one
  std::string model;     // in the file's words: "pinhole, equidistant"
  Lens lens;             // a width of 0: the file does not say the size
  std::string odd_size;  // where the file says a size that is none: its words
  double skew_px = 0.0;
  std::vector<std::string> notes;  // what was decided that a person may see otherwise
  std::string refused;             // why `lens` is not it; empty: it is
};

inline constexpr std::uint64_t kMaxCalibrationBytes = std::uint64_t{512} << 10U;

// All lenses of a file, at least one. The error says what was expected and what was found; `name`
// stands for the file there.
Result<std::vector<ForeignLens>> parse_foreign_lenses(
    const std::string& text, const std::string& name,
    ForeignModel model = ForeignModel::kAsTheFileSays);
Result<std::vector<ForeignLens>> read_foreign_lenses(
    const std::filesystem::path& path, ForeignModel model = ForeignModel::kAsTheFileSays);

}  // namespace zenith::tools
