#pragma once
// From boards seen in images to a lens that can be trusted, or to what to do again.

#include <string>
#include <vector>

#include "platform/base/result.h"
#include "tools/calibrate/coverage.h"
#include "tools/calibrate/detect.h"
#include "tools/calibrate/judgement.h"
#include "tools/calibrate/lens_fit.h"

namespace zenith::tools {

// An image with what was found in it; the error says why nothing was.
struct SeenBoard {
  std::string name;
  Result<Detection> found;
};

struct ImageReport {
  std::string name;
  std::string refused;  // why it was not used; empty: used
  std::size_t corners = 0;
  double rms_px = 0.0;
};

struct LensCalibration {
  LensFit fit;  // its poses belong to `views`
  std::vector<BoardView> views;
  std::vector<ImageReport> images;  // all, in the order given
  double rms_px = 0.0;
  Coverage coverage;
  Judgement judgement;

  // Standard deviations.
  double centre_sigma_px() const;
  double focal_sigma() const;  // relative
};

// Views whose errors stand out from the others' are left out, the worst first. An error when too
// few views remain to fit anything.
Result<LensCalibration> calibrate_lens(const std::vector<SeenBoard>& boards, const Target& target,
                                       int width_px, int height_px);

// The result as a person reads it.
std::string lens_report(const LensCalibration& calibration);

// All corners of the used views.
std::vector<Eigen::Vector2d> all_corners(const LensCalibration& calibration);

}  // namespace zenith::tools
