#pragma once
// Whether what a codec reads can be wheels at all. A codec that reads other bytes than the base
// sends (byte order, width, sign, signal, unit) does not fail: it gives numbers. Three things show:
//
//   nonsense   3 % and more of the last steps are faster than max_speed, without a silence in which
//              the base could have restarted; or velocities that are
//   wraps      such steps, rare, but all of the same size: a counter wraps at another width
//   stands     one wheel never moved while the other rolled 6 m: a robot that turns about the
//              standing one makes more than two full turns until then
//
// Plain data, no heap, no lock.

#include <cstdint>
#include <string>

namespace zenith {

enum class WheelFaultKind : std::uint8_t { kNone, kNonsense, kWraps, kLeftStands, kRightStands };

struct WheelFault {
  WheelFaultKind kind = WheelFaultKind::kNone;
  double share = 0.0;       // of the last steps, impossible: kNonsense
  double jump_units = 0.0;  // kWraps: the size of the steps, in the base's units
  double travel_m = 0.0;    // of the other wheel: kLeftStands, kRightStands
};

class WheelWatch {
 public:
  // A step that a wheel can make. Standing is none.
  void moved();
  // One that no wheel can make; of velocities, the value.
  void jumped(double units);
  // Both wheels' total travel.
  void travelled(double left_m, double right_m);

  WheelFault fault() const;

 private:
  double good_ = 0.0;  // steps, the last some hundred
  double bad_ = 0.0;
  double jump_units_ = 0.0;
  int same_jumps_ = 0;  // in a row
  double left_m_ = 0.0;
  double right_m_ = 0.0;
  double left_path_m_ = 0.0;  // forward and backward
  double right_path_m_ = 0.0;
};

// What was found, expected, and the likely cause, in one line without an end; empty for kNone.
// Allocates.
std::string wheel_fault_text(const WheelFault& fault);

}  // namespace zenith
