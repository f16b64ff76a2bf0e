#include "drivers/odometry/wheel_decoder.h"

#include <algorithm>

namespace zenith {
namespace {

bool is_any(WheelStep step, const std::optional<WheelStep>& left,
            const std::optional<WheelStep>& right) {
  return left == step || right == step;
}

}  // namespace

WheelDecoder::WheelDecoder(const WheelLimits& limits)
    : WheelDecoder(agilex_v2::Codec{}, agilex_v2::Codec{}.scales({}), limits) {}

WheelDecoder::WheelDecoder(const WheelCodec& codec, const WheelScales& scales,
                           const WheelLimits& limits)
    : codec_(codec), left_(scales.left, limits), right_(scales.right, limits) {}

CanIds WheelDecoder::ids() const {
  return std::visit([](const auto& codec) { return codec.ids(); }, codec_);
}

std::optional<WheelSample> WheelDecoder::decode(const CanFrame& frame) {
  const WheelNews news =
      std::visit([&frame](const auto& codec) { return codec.read(frame); }, codec_);
  switch (news.use) {
    case FrameUse::kUnknownId:
      ++counters_.unknown_ids;
      return std::nullopt;
    case FrameUse::kTooShort:
      ++counters_.short_frames;
      return std::nullopt;
    case FrameUse::kNoTravel:
      ++counters_.without_travel;
      note_errors(news);
      return std::nullopt;
    case FrameUse::kReading:
      break;
  }
  return take(frame.stamp, news);
}

std::optional<WheelSample> WheelDecoder::take(Time stamp_of_news, const WheelNews& news) {
  if (!accept(stamp_of_news, news) || !fresh_left_ || !fresh_right_) return std::nullopt;
  fresh_left_ = false;
  fresh_right_ = false;
  ++counters_.samples;
  const Time stamp = std::min(left_.stamp(), right_.stamp());
  const WheelSample sample = {stamp - latency_, left_.travel_at(stamp), right_.travel_at(stamp)};
  watch_.travelled(sample.left_m, sample.right_m);
  return sample;
}

void WheelDecoder::watch(Time stamp, const WheelReading& reading, WheelStep step,
                         const WheelAccumulator& wheel) {
  const double units = wheel.step_units(reading);
  if (step == WheelStep::kInvalid || (step == WheelStep::kRestarted && !wheel.was_silent(stamp))) {
    watch_.jumped(units);
  } else if (step == WheelStep::kMoved && units != 0.0) {
    watch_.moved();
  }
}

void WheelDecoder::note_errors(const WheelNews& news) {
  if (news.left_error) errors_.left = *news.left_error;
  if (news.right_error) errors_.right = *news.right_error;
  if (news.left_error.value_or(0) != 0 || news.right_error.value_or(0) != 0) {
    ++counters_.error_reports;
  }
}

// False when the frame is refused as a whole.
bool WheelDecoder::accept(Time stamp, const WheelNews& news) {
  std::optional<WheelStep> left;
  std::optional<WheelStep> right;
  if (news.left) left = left_.judge(stamp, *news.left);
  if (news.right) right = right_.judge(stamp, *news.right);
  if (is_any(WheelStep::kLate, left, right)) {
    ++counters_.late;
    return false;
  }
  if (left) watch(stamp, *news.left, *left, left_);
  if (right) watch(stamp, *news.right, *right, right_);
  if (is_any(WheelStep::kInvalid, left, right)) {
    ++counters_.invalid;
    return false;
  }
  if ((left && left_.ends_velocity_gap(stamp)) || (right && right_.ends_velocity_gap(stamp))) {
    ++counters_.velocity_gaps;
  }
  if (is_any(WheelStep::kRestarted, left, right)) {
    ++counters_.resets;
    if (left) left = WheelStep::kRestarted;
    if (right) right = WheelStep::kRestarted;
  }
  if (left) take_wheel(stamp, *news.left, *left, left_, fresh_left_);
  if (right) take_wheel(stamp, *news.right, *right, right_, fresh_right_);
  return true;
}

void WheelDecoder::take_wheel(Time stamp, const WheelReading& reading, WheelStep step,
                              WheelAccumulator& wheel, bool& fresh) {
  wheel.take(stamp, reading, step);
  if (fresh) ++counters_.unpaired;
  fresh = true;
}

}  // namespace zenith
