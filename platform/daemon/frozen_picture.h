#pragma once
// Finds a camera that gives an old picture again and again under new stamps, as a loop-back device
// does whose writer died, or a sensor whose driver hangs.
//
// A real sensor has noise: two of its frames are never equal in thousands of pixels. A picture that
// is made (a test pattern, a simulation) may well be the same twice, but not while the robot moves.
// So pictures and wheels are asked together:
//
//   digest    of kRows rows of the picture
//   repeated  the digest is that of the frame before, and enough of these pixels are neither black
//             nor white, where noise and motion would not show
//   stale     repeated, and since the picture was new a wheel has moved by more than kStale_m: what
//             it shows was somewhere else
//   frozen    stale, for kFrozenRepeats frames and kFrozen_m: the camera is to be opened again
//
// A robot that stands is never told to be frozen. Plain data: no heap, some 5 kB are read per
// frame.

#include <cstdint>
#include <optional>

#include "slam/image/image.h"
#include "slam/wheels.h"

namespace zenith {

class FrozenPicture {
 public:
  static constexpr int kRows = 8;
  // Grey levels beyond which a sensor's noise may be cut off.
  static constexpr std::uint8_t kDarkest = 8;
  static constexpr std::uint8_t kBrightest = 247;
  static constexpr int kMinInformative = 64;  // pixels between these
  // What the filter takes for motion begins here (slam.min_travel_m).
  static constexpr double kStale_m = 0.005;
  static constexpr double kFrozen_m = 0.1;
  static constexpr int kFrozenRepeats = 3;

  enum class Verdict {
    kNew,       // another picture than the last one, or nothing can be said
    kRepeated,  // the same, and the robot has not moved
    kStale,     // the same, and it has: not to be used
    kFrozen,    // likewise, for long
  };

  // Each sample of the wheels, as it comes.
  void note_wheels(const WheelSample& sample);
  // Each frame, once the wheels of its moment were noted. Reopening the camera changes nothing: the
  // picture counts as frozen until another one comes.
  Verdict judge(const ImageView& picture);

 private:
  struct Digest {
    std::uint64_t value = 0;
    int informative = 0;
  };
  static Digest digest_of(const ImageView& picture);

  std::optional<WheelSample> wheels_;         // the newest
  std::optional<WheelSample> wheels_at_new_;  // when the picture was new
  double moved_m_ = 0.0;                      // at most, since then
  bool known_ = false;
  std::uint64_t digest_ = 0;
  int repeats_ = 0;
};

}  // namespace zenith
