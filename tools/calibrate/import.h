#pragma once
// Lenses that other programs calibrated: Kalibr's camchain, OpenCV's FileStorage, ROS's
// camera_info, Basalt's JSON.
//
// Lenses are taken as they are, in their own model (slam/image/lens.h).

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "slam/image/lens.h"

namespace zenith::tools {

// A lens in its own model. Names as Kalibr's: "pinhole-equi", "pinhole-radtan", "pinhole-none",
// "pinhole-fov", "eucm-none", "ds-none", "omni-radtan", "omni-none"; "pinhole-rational" is ROS's.
struct ForeignLens {
  std::string format;  // "Kalibr", ...
  std::string camera;  // its name in the file, empty when there is only one
  std::string model;
  int width_px = 0;
  int height_px = 0;
  std::vector<double> intrinsics;  // model's own, then fu, fv, cu, cv
  std::vector<double> distortion;
};

inline constexpr std::uint64_t kMaxCalibrationBytes = std::uint64_t{512} << 10U;

// All lenses of a file. The error says what was expected and what was found; `name` stands for the
// file there.
Result<std::vector<ForeignLens>> parse_foreign_lenses(const std::string& text,
                                                      const std::string& name);
Result<std::vector<ForeignLens>> read_foreign_lenses(const std::filesystem::path& path);

struct ImportedLens {
  Lens lens;
  double widest_deg = 0.0;  // from the axis, in the image
  std::string note;         // lens_note()
};

// Refused when the model is none of slam/image/lens.h, or check_lens() refuses it.
Result<ImportedLens> import_lens(const ForeignLens& foreign);

}  // namespace zenith::tools
