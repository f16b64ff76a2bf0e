#include "tools/bent/bends.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "platform/base/random.h"

namespace zenith::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Time after_start(const Tape& tape, double seconds) {
  return tape.start() + Duration::from_seconds(seconds);
}

using Change = std::function<void(const TapeFrame&, Pixels&)>;

void change_pictures(Tape& tape, const std::function<bool(const TapeFrame&)>& which,
                     const Change& change) {
  for (TapeFrame& frame : tape.frames) {
    if (!which(frame)) continue;
    Pixels pixels = *frame.pixels;
    change(frame, pixels);
    frame.pixels = std::make_shared<const Pixels>(std::move(pixels));
  }
}

bool always(const TapeFrame&) {
  return true;
}

Duration frame_period(const Tape& tape) {
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < tape.frames.size(); ++i) {
    intervals.push_back((tape.frames[i].stamp - tape.frames[i - 1].stamp).ns);
  }
  if (intervals.empty()) return {100'000'000};
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return {*middle};
}

// The last sample at or before `stamp`, or the first one.
WheelSample wheels_at(const Tape& tape, Time stamp) {
  WheelSample last = tape.wheels.front();
  for (const WheelSample& w : tape.wheels) {
    if (w.stamp > stamp) break;
    last = w;
  }
  return last;
}

}  // namespace

void mirror_pictures(Tape& tape) {
  const auto width = tape.config.lens.width_px;
  change_pictures(tape, always, [width](const TapeFrame&, Pixels& pixels) {
    for (auto row = pixels.begin(); row != pixels.end(); row += width) {
      std::reverse(row, row + width);
    }
  });
}

void turn_mount(Tape& tape, double degrees) {
  tape.config.mount.yaw_rad = wrap_angle(tape.config.mount.yaw_rad + degrees * kDegree);
}

void shift_centre(Tape& tape, double columns_px, double rows_px) {
  tape.config.lens.cu_px += columns_px;
  tape.config.lens.cv_px += rows_px;
}

void scale_focal(Tape& tape, double factor) {
  tape.config.lens.fu_px *= factor;
  tape.config.lens.fv_px *= factor;
}

void scale_resolution(Tape& tape, double factor) {
  scale_focal(tape, factor);
  tape.config.lens.cu_px *= factor;
  tape.config.lens.cv_px *= factor;
}

void swap_wheels(Tape& tape) {
  for (WheelSample& w : tape.wheels) std::swap(w.left_m, w.right_m);
}

void reverse_wheels(Tape& tape, WhichWheel which) {
  for (WheelSample& w : tape.wheels) {
    if (which != WhichWheel::kRight) w.left_m = -w.left_m;
    if (which != WhichWheel::kLeft) w.right_m = -w.right_m;
  }
}

void scale_wheels(Tape& tape, double factor) {
  const WheelSample first = tape.wheels.front();
  for (WheelSample& w : tape.wheels) {
    w.left_m = first.left_m + factor * (w.left_m - first.left_m);
    w.right_m = first.right_m + factor * (w.right_m - first.right_m);
  }
}

void delay_wheels(Tape& tape, double delay_s) {
  for (WheelSample& w : tape.wheels) w.stamp = w.stamp + Duration::from_seconds(delay_s);
}

void slip(Tape& tape, double at_s, double duration_s, double left_m, double right_m) {
  const Time at = after_start(tape, at_s);
  const Duration length = Duration::from_seconds(duration_s);
  const Duration period = frame_period(tape);
  std::vector<TapeFrame> frames;
  Random random(7, 1);
  for (const TapeFrame& frame : tape.frames) {
    if (frame.stamp <= at) frames.push_back(frame);
  }
  const TapeFrame stood = frames.back();
  for (Duration t = period; t < length; t = t + period) {
    Pixels pixels = *stood.pixels;
    for (std::uint8_t& p : pixels) {
      p = static_cast<std::uint8_t>(std::clamp(p + 1.5 * random.normal(), 0.0, 255.0));
    }
    frames.push_back(
        {stood.stamp + t, std::make_shared<const Pixels>(std::move(pixels)), stood.truth});
  }
  for (const TapeFrame& frame : tape.frames) {
    if (frame.stamp > at) frames.push_back({frame.stamp + length, frame.pixels, frame.truth});
  }
  std::vector<WheelSample> wheels;
  const WheelSample before = wheels_at(tape, at);
  for (const WheelSample& w : tape.wheels) {
    if (w.stamp <= at) wheels.push_back(w);
  }
  const int steps = std::max(2, static_cast<int>(duration_s / 0.01));
  for (int i = 1; i < steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    wheels.push_back({at + Duration::from_seconds(s * duration_s), before.left_m + s * left_m,
                      before.right_m + s * right_m});
  }
  for (const WheelSample& w : tape.wheels) {
    if (w.stamp > at) {
      wheels.push_back({w.stamp + length, w.left_m + left_m, w.right_m + right_m});
    }
  }
  tape.frames = std::move(frames);
  tape.wheels = std::move(wheels);
}

void push(Tape& tape, double from_s, double to_s) {
  const Time from = after_start(tape, from_s);
  const Time to = after_start(tape, to_s);
  const WheelSample a = wheels_at(tape, from);
  const WheelSample b = wheels_at(tape, to);
  for (WheelSample& w : tape.wheels) {
    if (w.stamp <= from) continue;
    const bool meanwhile = w.stamp <= to;
    w.left_m = meanwhile ? a.left_m : w.left_m - b.left_m + a.left_m;
    w.right_m = meanwhile ? a.right_m : w.right_m - b.right_m + a.right_m;
  }
}

void carry(Tape& tape, double lifted_s, double down_s) {
  const Time lifted = after_start(tape, lifted_s);
  const Time down = after_start(tape, down_s);
  const WheelSample a = wheels_at(tape, lifted);
  const WheelSample b = wheels_at(tape, down);
  const Duration back = down - (lifted + Duration{50'000'000});
  std::vector<TapeFrame> frames;
  std::vector<WheelSample> wheels;
  for (const TapeFrame& f : tape.frames) {
    if (f.stamp <= lifted) frames.push_back(f);
    if (f.stamp > down) frames.push_back({f.stamp - back, f.pixels, f.truth});
  }
  for (const WheelSample& w : tape.wheels) {
    if (w.stamp <= lifted) wheels.push_back(w);
    if (w.stamp > down) {
      wheels.push_back(
          {w.stamp - back, w.left_m - b.left_m + a.left_m, w.right_m - b.right_m + a.right_m});
    }
  }
  tape.frames = std::move(frames);
  tape.wheels = std::move(wheels);
}

void drop_frames(Tape& tape, double from_s, double to_s) {
  const Time from = after_start(tape, from_s);
  const Time to = after_start(tape, to_s);
  std::erase_if(tape.frames, [&](const TapeFrame& f) { return f.stamp > from && f.stamp < to; });
}

void cover_lens(Tape& tape, double from_s, double to_s) {
  const Time from = after_start(tape, from_s);
  const Time to = after_start(tape, to_s);
  change_pictures(
      tape, [&](const TapeFrame& f) { return f.stamp >= from && f.stamp < to; },
      [](const TapeFrame&, Pixels& pixels) { std::fill(pixels.begin(), pixels.end(), 8); });
}

void cover_side(Tape& tape, double share) {
  const int width = tape.config.lens.width_px;
  const auto covered = static_cast<std::ptrdiff_t>(share * width);
  change_pictures(tape, always, [=](const TapeFrame&, Pixels& pixels) {
    for (auto row = pixels.begin(); row != pixels.end(); row += width) {
      std::fill(row, row + covered, 8);
    }
  });
}

void freeze_picture(Tape& tape, double from_s) {
  const Time from = after_start(tape, from_s);
  std::shared_ptr<const Pixels> kept;
  for (TapeFrame& frame : tape.frames) {
    if (frame.stamp < from || !kept) {
      kept = frame.pixels;
    } else {
      frame.pixels = kept;
    }
  }
}

void repeat_frames(Tape& tape) {
  const Duration half = {frame_period(tape).ns / 2};
  std::vector<TapeFrame> frames;
  for (const TapeFrame& frame : tape.frames) {
    frames.push_back(frame);
    frames.push_back({frame.stamp + half, frame.pixels, frame.truth});
  }
  tape.frames = std::move(frames);
}

void jitter_stamps(Tape& tape, double sigma_s, std::uint64_t seed) {
  Random random(seed, 3);
  Time last = tape.start() - Duration{1'000'000'000};
  for (TapeFrame& frame : tape.frames) {
    frame.stamp = std::max(frame.stamp + Duration::from_seconds(sigma_s * random.normal()),
                           last + Duration{1'000'000});
    last = frame.stamp;
  }
}

void blank_pictures(Tape& tape) {
  change_pictures(tape, always, [](const TapeFrame&, Pixels& pixels) {
    std::fill(pixels.begin(), pixels.end(), 120);
  });
}

void put_robot_in_view(Tape& tape, double radius_px) {
  const Lens lens = tape.config.lens;
  const double centre_u = lens.cu_px - 0.6 * lens.fu_px;
  const double centre_v = lens.cv_px;
  change_pictures(tape, always, [=](const TapeFrame&, Pixels& pixels) {
    for (int v = 0; v < lens.height_px; ++v) {
      for (int u = 0; u < lens.width_px; ++u) {
        if (std::hypot(u - centre_u, v - centre_v) > radius_px) continue;
        const bool bright = ((u / 9) + (v / 9)) % 2 == 0 || (u / 9) % 3 == 0;
        pixels[static_cast<std::size_t>(v * lens.width_px + u)] = bright ? 90 : 30;
      }
    }
  });
}

namespace {

void add_setups(std::vector<Bend>& bends, bool quick) {
  bends.push_back({"mirror", mirror_pictures});
  const auto yaw = [&](int degrees) {
    bends.push_back({"yaw " + std::to_string(degrees) + " deg",
                     [degrees](Tape& t) { turn_mount(t, degrees); }});
  };
  yaw(90);
  if (!quick) {
    for (const int degrees : {180, -90, 30, 10, 5, 3}) yaw(degrees);
    for (const int px : {4, 8, 20, 40}) {
      bends.push_back({"centre " + std::to_string(px) + " px",
                       [px](Tape& t) { shift_centre(t, px, -0.5 * px); }});
    }
    for (const double f : {0.8, 0.9, 1.1, 1.25}) {
      bends.push_back(
          {"focal " + std::to_string(f).substr(0, 4), [f](Tape& t) { scale_focal(t, f); }});
    }
    bends.push_back({"half resolution", [](Tape& t) { scale_resolution(t, 0.5); }});
  }
  bends.push_back({"swap", swap_wheels});
  bends.push_back({"invert left", [](Tape& t) { reverse_wheels(t, WhichWheel::kLeft); }});
  if (!quick) {
    bends.push_back({"invert right", [](Tape& t) { reverse_wheels(t, WhichWheel::kRight); }});
    bends.push_back({"invert both", [](Tape& t) { reverse_wheels(t, WhichWheel::kBoth); }});
    for (const double f : {0.8, 0.95, 1.05, 1.1, 1.3}) {
      bends.push_back(
          {"scale " + std::to_string(f).substr(0, 4), [f](Tape& t) { scale_wheels(t, f); }});
    }
  }
  for (const int ms : quick ? std::vector<int>{100} : std::vector<int>{-100, 30, 100, 250}) {
    bends.push_back(
        {"late " + std::to_string(ms) + " ms", [ms](Tape& t) { delay_wheels(t, 0.001 * ms); }});
  }
}

void add_events(std::vector<Bend>& bends, double T, bool quick) {
  const double at = 0.4 * T;
  const auto add = [&](const char* name, std::function<void(Tape&)> apply) {
    bends.push_back({name, std::move(apply)});
  };
  add("slip 11 cm left", [at](Tape& t) { slip(t, at, 0.3, 0.11, 0.0); });
  add("frozen", [at](Tape& t) { freeze_picture(t, at); });
  if (quick) return;
  add("slip 20 cm both", [at](Tape& t) { slip(t, at, 1.0, 0.2, 0.2); });
  add("slip 50 cm both", [at](Tape& t) { slip(t, at, 2.0, 0.5, 0.5); });
  add("slip 40 deg", [at](Tape& t) { slip(t, at, 1.0, -0.14, 0.14); });
  add("pushed 0.5 s", [at](Tape& t) { push(t, at, at + 0.5); });
  add("pushed 2 s", [at](Tape& t) { push(t, at, at + 2.0); });
  add("carried ahead", [T](Tape& t) { carry(t, 0.4 * T, 0.7 * T); });
  add("no frames 1 s", [at](Tape& t) { drop_frames(t, at, at + 1.0); });
  add("no frames 4 s", [at](Tape& t) { drop_frames(t, at, at + 4.0); });
  add("covered 1 s", [at](Tape& t) { cover_lens(t, at, at + 1.0); });
  add("covered 6 s", [at](Tape& t) { cover_lens(t, at, at + 6.0); });
  add("twice", repeat_frames);
  for (const int ms : {5, 10, 25}) {
    bends.push_back({"jitter " + std::to_string(ms) + " ms",
                     [ms](Tape& t) { jitter_stamps(t, 0.001 * ms, 3); }});
  }
  add("blind", blank_pictures);
  add("covered by a third", [](Tape& t) { cover_side(t, 0.33); });
  add("covered by a half", [](Tape& t) { cover_side(t, 0.5); });
  add("robot in view", [](Tape& t) { put_robot_in_view(t, 55.0); });
}

}  // namespace

std::vector<Bend> list_bends(double duration_s, bool quick) {
  std::vector<Bend> bends;
  bends.push_back({"unbent", [](Tape&) {}});
  add_setups(bends, quick);
  add_events(bends, duration_s, quick);
  return bends;
}

}  // namespace zenith::tools
