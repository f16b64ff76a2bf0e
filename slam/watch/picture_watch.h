#pragma once
// Pictures that tell nothing: the same one again while the wheels turn, a covered lens, a ceiling
// without corners; frames that do not come.

#include "slam/filter/motion.h"
#include "slam/image/image.h"
#include "slam/watch/reasons.h"

namespace zenith {

struct WatchedPicture {
  ImageView rectified;
  int corners = 0;
  bool repeated = false;  // it is the last one's, bit for bit
};

class PictureWatch {
 public:
  // `travel` of each wheel since the last call, metres.
  void observe(Time stamp, const WatchedPicture& picture, const WheelTravel& travel,
               Reasons& reasons);

 private:
  void note_interval(Time stamp, double travel_m, Reasons& reasons);
  void note_repeats(bool repeated, Time stamp, Reasons& reasons);
  void note_blindness(const WatchedPicture& picture, double travel_m, Time stamp, Reasons& reasons);

  bool begun_ = false;
  Time last_;
  double period_s_ = 0.0;      // of frames, running mean
  double repeat_share_ = 0.0;  // running, of frames with moving wheels
  int repeats_in_row_ = 0;
  double blind_m_ = 0.0;  // travel without corners
};

}  // namespace zenith
