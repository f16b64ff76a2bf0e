#pragma once
// The formats, each known by its keys or by its first words.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/calibrate/import/foreign_lens.h"
#include "tools/calibrate/import/tree.h"

namespace zenith::tools {

using ForeignLenses = std::vector<ForeignLens>;

// A reader of one format: the lens that a map describes, none when the map is no camera of this
// format. `name` is the camera's name in the file.
using KeyedReader = std::optional<ForeignLens> (*)(const Node& map, const std::string& name,
                                                   ForeignModel wanted);

// Kalibr's camchain, EuRoC's sensor.yaml, OpenVINS.
std::optional<ForeignLens> read_kalibr(const Node& map, const std::string& name,
                                       ForeignModel wanted);
// "pinhole", "omni", "ds", "eucm" with a distortion, numbers in Kalibr's order; others write the
// same.
ForeignLens kalibr_lens(const Node& map, const std::string& name, const std::string& format,
                        const std::string& camera_model, const std::string& distortion,
                        const Node& intrinsics, const Node* coefficients, ForeignModel wanted);
// SVO, maplab: `camera` with type, intrinsics.data, distortion.parameters.
std::optional<ForeignLens> read_svo(const Node& map, const std::string& name, ForeignModel wanted);
// OKVIS: focal_length, principal_point.
std::optional<ForeignLens> read_okvis(const Node& map, const std::string& name,
                                      ForeignModel wanted);
std::optional<ForeignLens> read_basalt(const Node& map, const std::string& name,
                                       ForeignModel wanted);
// VINS-Mono and VINS-Fusion, by model_type.
std::optional<ForeignLens> read_camodocal(const Node& map, const std::string& name,
                                          ForeignModel wanted);
// fx, fy, cx, cy as keys of their own: ORB-SLAM, stella_vslam, librealsense, nerfstudio, SVO.
std::optional<ForeignLens> read_plain_keys(const Node& map, const std::string& name,
                                           ForeignModel wanted);
// The same keys below two others: "intrinsics: {fx: ..}, distortion: {k1: ..}".
std::optional<ForeignLens> read_nested_keys(const Node& map, const std::string& name,
                                            ForeignModel wanted);
// A camera matrix and distortion coefficients, under the names of OpenCV's and ROS's files; two
// and more of them in files of stereo cameras.
ForeignLenses read_matrices(const Node& map, const std::string& name, ForeignModel wanted);

// All lenses of a tree, wherever in it they are.
ForeignLenses find_lenses(const Documents& documents, ForeignModel wanted);
// Files that a calibration names instead of a lens: "cam0.yaml, cam1.yaml".
std::string named_files(const Documents& documents);

// Formats of their own. None: the text is none of them.
std::optional<Result<ForeignLenses>> read_plain_text(std::string_view text, ForeignModel wanted);

}  // namespace zenith::tools
