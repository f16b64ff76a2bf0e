#pragma once
// A driver's 32-bit sequence numbers, unwrapped to frames since open().
//
// Numbers may start anywhere and wrap. A repeated number, one that goes back, or a jump of more
// than kMaxGap says that the driver does not count or has begun anew: the next frame then.

#include <cstdint>

namespace zenith {

class FrameSequence {
 public:
  static constexpr std::uint32_t kMaxGap = 1000;

  // The number of the frame that carries `driver` (0 for the first), and how many were lost before.
  struct Step {
    std::uint64_t number = 0;
    std::uint64_t lost = 0;
  };

  Step advance(std::uint32_t driver) {
    std::uint32_t step = driver - last_;
    if (!started_) {
      started_ = true;
      step = 0;
    } else if (step == 0 || step > kMaxGap) {
      step = 1;
    }
    last_ = driver;
    number_ += step;
    return {number_, step > 1 ? step - 1 : 0};
  }

  void reset() { *this = {}; }

 private:
  bool started_ = false;
  std::uint32_t last_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace zenith
