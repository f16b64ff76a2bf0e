#pragma once
// When a frame was taken, of a camera whose stamps jitter. A camera takes frames at equal
// intervals; stamps that a busy computer gives scatter around them. The wheels must be asked for
// the moment of the picture: at 0.5 m/s a stamp that is 25 ms off makes one motion 12 mm too long
// and the next one as much too short.
//
//   t_k = a + b n_k + e_k,   n: number of the interval, gaps included
//
// a, b by recursive least squares over kMemory frames (as Olson, "A passive solution to the sensor
// synchronization problem", IROS 2010, for clocks). Stamps are taken as they are unless they are
// seen to scatter around equal intervals: e_k of neighbours is independent, so that a long interval
// is followed by a short one (correlation -1/2). Where the camera itself is irregular, intervals
// are independent.

#include <cstdint>

#include "platform/base/fixed_vector.h"
#include "platform/base/time.h"

namespace zenith {

class FrameClock {
 public:
  // Stamps rise. The moments rise, too; each lies at most one and a half intervals beside its
  // stamp.
  Time taken(Time stamp);

  // Standard deviation of the stamps around equal intervals in seconds; 0: they are taken as they
  // are.
  double jitter_s() const { return corrects_ ? sigma_s_ : 0.0; }

 private:
  static constexpr int kMemory = 150;
  static constexpr int kFirst = 16;

  void begin(Time stamp);
  void begin_line();
  bool follow(double t);
  // By how many intervals a stamp may be off.
  double scatter(double period_s) const;
  void judge(double deviation_s, double off_s);

  bool begun_ = false;
  Time origin_;  // n = 0
  Time last_;    // stamp
  Time last_taken_;
  double period_s_ = 0.0;
  double phase_s_ = 0.0;  // of the line at the last frame, seconds since origin_
  // Of the recursive least squares: covariance of (phase, period), in units of the stamps'
  // variance.
  double p00_ = 0.0;
  double p01_ = 0.0;
  double p11_ = 0.0;
  int frames_ = 0;
  double last_s_ = 0.0;
  FixedVector<double, kFirst> first_;  // stamps before there is a line
  // Running means over intervals.
  double square_ = 0.0;   // of their deviation
  double product_ = 0.0;  // of neighbours' deviations
  double beside_ = 0.0;   // of their distance from the line, squared
  double last_deviation_s_ = 0.0;
  double sigma_s_ = 0.0;
  bool corrects_ = false;
};

}  // namespace zenith
