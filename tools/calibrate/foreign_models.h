#pragma once
// Projections of other lens models.

#include <optional>

#include <Eigen/Core>

#include "platform/base/result.h"
#include "tools/calibrate/import.h"

namespace zenith::tools {

// Whether the model is known here, with as many numbers as it needs.
Status check_model(const ForeignLens& lens);

// Pixel of a ray in the camera frame; none where the model shows none. The model must be known.
std::optional<Eigen::Vector2d> project_foreign(const ForeignLens& lens, const Eigen::Vector3d& ray);

}  // namespace zenith::tools
