#pragma once
// Images of a target as a known fisheye lens sees them: to try a calibration without a camera, and
// to test one against the truth.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "platform/base/random.h"
#include "platform/base/result.h"
#include "sim/camera.h"
#include "sim/sensor.h"
#include "tools/calibrate/lens_fit.h"
#include "tools/calibrate/target.h"

namespace zenith::tools {

// A lens of 190 degrees for 640 x 480 pixels, a little different for each seed.
Lens sample_lens(std::uint64_t seed);

class SampleCamera {
 public:
  SampleCamera(const Lens& lens, const Target& target, std::uint64_t seed);

  // A board held in front of the camera in this pose. Rendered in its exact geometry with 16 rays a
  // pixel, the lens's and the sensor's faults included.
  std::vector<std::uint8_t> image(const BoardPose& pose);

  // As a person would hold it for view `index` of `count`: in the middle first, then round the rim,
  // near and far, leaning to all sides, and whole in the image.
  BoardPose held(int index, int count);

 private:
  bool in_view(const BoardPose& pose) const;

  Lens lens_;
  Target target_;
  cv::Mat raster_;
  sim::CameraSpec spec_;
  sim::Camera camera_;
  sim::Sensor sensor_;
  Random random_;
};

struct SamplePlan {
  Target target;
  int views = 30;
  std::uint64_t seed = 1;
};

// Images, and the truth as sensor.yaml, into `folder`, which exists.
Status write_samples(const SamplePlan& plan, const std::filesystem::path& folder);

}  // namespace zenith::tools
