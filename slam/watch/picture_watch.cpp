#include "slam/watch/picture_watch.h"

#include <algorithm>
#include <cmath>

namespace zenith {
namespace {

constexpr double kTurns_m = 0.004;    // travel of a wheel from which pictures must differ
constexpr double kForget = 1.0 / 40;  // frames
constexpr double kRepeatShare = 0.1;
constexpr int kFrozenFrames = 8;
constexpr double kDark = 14.0;  // grey levels, on average
constexpr int kFewCorners = 8;
constexpr double kBlind_m = 0.3;
constexpr double kMissing_s = 0.8;
constexpr double kMissing_m = 0.25;

// Of every 256th pixel.
double mean_grey(const ImageView& image) {
  constexpr int kEvery = 16;
  int sum = 0;
  int count = 0;
  for (int v = kEvery / 2; v < image.height; v += kEvery) {
    for (int u = kEvery / 2; u < image.width; u += kEvery) {
      sum += image.at(u, v);
      ++count;
    }
  }
  return count > 0 ? static_cast<double>(sum) / count : 0.0;
}

}  // namespace

void PictureWatch::observe(Time stamp, const WatchedPicture& picture, const WheelTravel& travel,
                           Reasons& reasons) {
  const double left_m = std::abs(travel.left_m);
  const double right_m = std::abs(travel.right_m);
  const double travel_m = 0.5 * (left_m + right_m);
  if (begun_) {
    note_interval(stamp, travel_m, reasons);
    if (std::max(left_m, right_m) > kTurns_m) note_repeats(picture.repeated, stamp, reasons);
  }
  note_blindness(picture, travel_m, stamp, reasons);
  begun_ = true;
  last_ = stamp;
}

void PictureWatch::note_interval(Time stamp, double travel_m, Reasons& reasons) {
  const double interval_s = (stamp - last_).seconds();
  if (interval_s > kMissing_s && interval_s > 3.0 * period_s_ && travel_m > kMissing_m) {
    reasons.happened(SetupCode::kFramesMissing, interval_s, stamp);
    return;
  }
  period_s_ += (period_s_ == 0.0 ? 1.0 : kForget) * (std::clamp(interval_s, 0.0, 2.0) - period_s_);
}

void PictureWatch::note_repeats(bool repeated, Time stamp, Reasons& reasons) {
  repeats_in_row_ = repeated ? repeats_in_row_ + 1 : 0;
  repeat_share_ += kForget * ((repeated ? 1.0 : 0.0) - repeat_share_);
  using enum SetupCode;
  reasons.set(kPictureFrozen, repeats_in_row_ >= kFrozenFrames, VerdictState::kWrong, 0.0, stamp);
  reasons.set(kFramesRepeated, repeat_share_ > kRepeatShare && !reasons.given(kPictureFrozen),
              VerdictState::kDoubtful, 100.0 * repeat_share_, stamp);
}

void PictureWatch::note_blindness(const WatchedPicture& picture, double travel_m, Time stamp,
                                  Reasons& reasons) {
  if (picture.corners >= kFewCorners) {
    blind_m_ = 0.0;
    return;
  }
  blind_m_ += travel_m;
  if (blind_m_ < kBlind_m) return;
  const bool dark = mean_grey(picture.rectified) < kDark;
  reasons.happened(dark ? SetupCode::kLensCovered : SetupCode::kNothingToSee, blind_m_, stamp);
}

}  // namespace zenith
