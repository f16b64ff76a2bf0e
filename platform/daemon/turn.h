#pragma once
// Whose turn a device is. The perception thread uses it; when it is lost, perception gives it to
// the keeper, which may take its time to open it, and gives it back. Whoever has the turn is the
// one caller that a driver's interface allows.

#include <atomic>

namespace zenith {

class Turn {
 public:
  bool is_perceptions() const { return perceptions_.load(std::memory_order_acquire); }
  // By the one who has it.
  void give_to_keeper() { perceptions_.store(false, std::memory_order_release); }
  void give_to_perception() { perceptions_.store(true, std::memory_order_release); }

 private:
  std::atomic<bool> perceptions_ = false;  // the keeper opens it first
};

}  // namespace zenith
