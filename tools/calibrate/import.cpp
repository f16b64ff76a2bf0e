#include "tools/calibrate/import.h"

#include <array>
#include <numbers>

#include "platform/config/lens_settings.h"
#include "slam/image/lens_extent.h"

namespace zenith::tools {
namespace {

// How a model's numbers stand in files: so many before fu, fv, cu, cv, then the distortion.
struct ForeignModel {
  const char* name;
  LensModel model;
  std::size_t least_distortion;
  std::size_t most_distortion;  // more than the model has: those behind must be zero
};

constexpr auto kModels = std::to_array<ForeignModel>({
    {"pinhole-equi", LensModel::kEquidistant, 4, 4},
    {"pinhole-radtan", LensModel::kRadtan, 4, 5},
    {"pinhole-rational", LensModel::kRational, 8, 14},
    {"pinhole-none", LensModel::kRadtan, 0, 5},
    {"pinhole-fov", LensModel::kFov, 1, 1},
    {"omni-radtan", LensModel::kOmni, 4, 4},
    {"omni-none", LensModel::kOmni, 0, 4},
    {"eucm-none", LensModel::kEucm, 0, 4},
    {"ds-none", LensModel::kDoubleSphere, 0, 4},
});

std::size_t projection_numbers(LensModel model) {
  switch (model) {
    case LensModel::kOmni:
      return 1;
    case LensModel::kEucm:
    case LensModel::kDoubleSphere:
      return 2;
    default:
      return 0;
  }
}

Result<const ForeignModel*> find_foreign_model(const std::string& name) {
  std::string known;
  for (const ForeignModel& model : kModels) {
    if (name == model.name) return &model;
    known += (known.empty() ? "" : ", ") + std::string(model.name);
  }
  return Error{"expected a lens of one of the models " + known + "; found '" + name +
               "'; calibrate with `zenith calibrate lens`"};
}

Status check_counts(const ForeignLens& foreign, const ForeignModel& model) {
  const std::size_t intrinsics = projection_numbers(model.model) + 4;
  if (foreign.intrinsics.size() != intrinsics) {
    return Error{foreign.model + ": expected " + std::to_string(intrinsics) +
                 " intrinsics, found " + std::to_string(foreign.intrinsics.size())};
  }
  const std::size_t found = foreign.distortion.size();
  if (found < model.least_distortion || found > model.most_distortion) {
    return Error{foreign.model + ": expected " + std::to_string(model.least_distortion) + " to " +
                 std::to_string(model.most_distortion) + " distortion coefficients, found " +
                 std::to_string(found)};
  }
  return {};
}

}  // namespace

Result<ImportedLens> import_lens(const ForeignLens& foreign) {
  const auto model = find_foreign_model(foreign.model);
  if (!model) return model.error();
  if (const Status counted = check_counts(foreign, **model); !counted) return counted.error();
  if (foreign.width_px < 16 || foreign.height_px < 16) {
    return Error{"expected the size of the image, found none"};
  }
  ImportedLens out;
  Lens& lens = out.lens;
  lens.model = (*model)->model;
  lens.width_px = foreign.width_px;
  lens.height_px = foreign.height_px;
  const std::size_t extra = projection_numbers(lens.model);
  const auto numbers = lens_numbers(lens.model);
  for (std::size_t i = 0; i < extra; ++i) numbers[i].at(lens) = foreign.intrinsics[i];
  lens.fu_px = foreign.intrinsics[extra];
  lens.fv_px = foreign.intrinsics[extra + 1];
  lens.cu_px = foreign.intrinsics[extra + 2];
  lens.cv_px = foreign.intrinsics[extra + 3];
  for (std::size_t i = 0; i < foreign.distortion.size(); ++i) {
    if (extra + i < numbers.size()) {
      numbers[extra + i].at(lens) = foreign.distortion[i];
    } else if (foreign.distortion[i] != 0.0) {
      return Error{foreign.model + ": the distortion coefficient " + std::to_string(i + 1) +
                   " is not zero; thin prism and tilt are not known here"};
    }
  }
  if (const Status good = check_lens(lens); !good) return good.error();
  out.widest_deg = lens_extent(LensProjection(lens)).widest_rad * 180.0 / std::numbers::pi;
  out.note = lens_note(lens);
  return out;
}

}  // namespace zenith::tools
