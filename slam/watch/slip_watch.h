#pragma once
// What happens on the way and neither wheels nor filter can be expected to bridge: wheels that slip
// far, a robot that is pushed or turned by hand, or lifted and put down elsewhere.
//
// Differences between seen and told motion are summed with a memory of about a second, so that a
// slip counts as a whole, whatever intervals it falls into.

#include "slam/watch/reasons.h"
#include "slam/watch/visual_motion.h"

namespace zenith {

struct ToldMotion {
  double forward_m = 0.0;
  double turn_rad = 0.0;
};

class SlipWatch {
 public:
  // One interval whose motion was seen. `per_m`: shift seen per metre driven, of the fit.
  void add(const VisualMotion& seen, const ToldMotion& told, double interval_s, double per_m,
           Time now, Reasons& reasons);
  // An interval of frames with corners that have nothing in common.
  void add_unmatched(const ToldMotion& told, double interval_s);

 private:
  double turn_rad_ = 0.0;  // seen less told, faded
  double forward_m_ = 0.0;
  double per_m_ = 0.0;  // of the place, running
  int matched_in_row_ = 0;
  int unmatched_ = 0;  // since enough were matched in a row
};

}  // namespace zenith
