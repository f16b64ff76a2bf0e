#include "tools/calibrate/live.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr double kStill_px = 1.5;
constexpr double kOther_share = 0.05;  // of the image's width: the board was moved on
constexpr std::size_t kFitEvery = 4;

// Mean distance of the corners that both have; none without any.
std::optional<double> distance_px(const Detection& a, const Detection& b) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < a.ids.size(); ++i) {
    const auto same = std::find(b.ids.begin(), b.ids.end(), a.ids[i]);
    if (same == b.ids.end()) continue;
    const auto k = static_cast<std::size_t>(same - b.ids.begin());
    sum += (a.corners_px[i] - b.corners_px[k]).norm();
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

bool is_new(const Detection& now, const std::vector<LiveView>& views, int width_px) {
  return std::all_of(views.begin(), views.end(), [&](const LiveView& view) {
    const auto distance = distance_px(now, *view.board.found);
    return !distance || *distance > kOther_share * width_px;
  });
}

// Where to go next, from a calibration of what there is; true when nothing is missing.
bool guide(const std::vector<LiveView>& views, const LivePlan& plan, int width_px, int height_px,
           const std::function<void(const std::string&)>& say) {
  std::vector<SeenBoard> boards;
  for (const LiveView& view : views) boards.push_back(view.board);
  const auto so_far = calibrate_lens(boards, plan.target, width_px, height_px);
  if (!so_far) return false;
  const auto missing = missing_cells(so_far->coverage);
  if (missing.empty()) return true;
  say(formatted("%zu views; %zu parts of the image are missing; next: hold the board ",
                views.size(), missing.size()) +
      missing[views.size() / kFitEvery % missing.size()]);
  return false;
}

}  // namespace

Result<std::vector<LiveView>> collect_views(Camera& camera, const LivePlan& plan,
                                            const std::function<bool()>& stop,
                                            const std::function<void(const std::string&)>& say) {
  if (const Status opened = camera.open(); !opened) return opened.error();
  say(camera.description());
  say("hold the board in front of the camera, whole in the image and still");
  std::vector<LiveView> views;
  std::optional<Detection> before;
  std::string last_said;
  double silent_s = 0.0;
  while (!stop() && views.size() < static_cast<std::size_t>(plan.views)) {
    constexpr double kWait_s = 0.25;
    CameraFrame frame;
    const CameraWait waited = camera.wait(Duration::from_seconds(kWait_s), frame);
    if (waited == CameraWait::kLost) {
      camera.close();
      return Error{std::string("the camera is lost: ") + camera.lost_reason()};
    }
    if (waited == CameraWait::kTimeout) {
      silent_s += kWait_s;
      if (silent_s < plan.patience_s) continue;
      camera.close();
      return Error{formatted("no frame came within %.0f s", plan.patience_s)};
    }
    silent_s = 0.0;
    const ImageView& luma = frame.luma;
    const cv::Mat image = cv::Mat(luma.height, luma.width, CV_8UC1,
                                  const_cast<std::uint8_t*>(luma.data),  // read and cloned
                                  static_cast<std::size_t>(luma.stride))
                              .clone();
    const auto found = detect_target(image, plan.target);
    if (!found) {
      before.reset();
      if (found.error().message != last_said) say(last_said = found.error().message);
      continue;
    }
    const auto moved = before ? distance_px(*found, *before) : std::nullopt;
    before = *found;
    if (!moved || *moved > kStill_px || !is_new(*found, views, luma.width)) continue;
    views.push_back({image, {formatted("view-%03zu", views.size()), *found}});
    say(last_said = formatted("view %zu taken; move the board on", views.size()));
    if (views.size() < 6 || views.size() % kFitEvery != 0) continue;
    const bool covered = guide(views, plan, luma.width, luma.height, say);
    if (covered && views.size() >= static_cast<std::size_t>(plan.enough)) break;
  }
  camera.close();
  return views;
}

}  // namespace zenith::tools
