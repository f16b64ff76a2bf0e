#pragma once
// Views of a board from a live camera: takes those in which the board is still and not where it was
// before, and says where to hold it next.

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "drivers/camera/camera.h"
#include "platform/base/result.h"
#include "tools/calibrate/lens_calibration.h"

namespace zenith::tools {

struct LivePlan {
  Target target;
  int views = 40;            // at most
  int enough = 20;           // with the whole image covered
  double patience_s = 10.0;  // without any frame
};

struct LiveView {
  cv::Mat image;
  SeenBoard board;
};

// `stop` is asked between frames; `say` gets a sentence for the person at each step. The camera is
// opened and closed here.
Result<std::vector<LiveView>> collect_views(Camera& camera, const LivePlan& plan,
                                            const std::function<bool()>& stop,
                                            const std::function<void(const std::string&)>& say);

}  // namespace zenith::tools
