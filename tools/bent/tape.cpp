#include "tools/bent/tape.h"

namespace zenith::tools {

Result<Tape> read_tape(Source& source) {
  Tape tape;
  tape.name = source.name();
  tape.config = source.config();
  SourceFrame frame;
  for (;;) {
    const auto more = source.next(frame);
    if (!more.ok()) return more.error();
    if (!*more) return tape;
    tape.frames.push_back({frame.stamp, std::make_shared<const Pixels>(frame.pixels), frame.truth});
    tape.wheels.insert(tape.wheels.end(), frame.wheels.begin(), frame.wheels.end());
  }
}

Result<bool> TapeSource::next(SourceFrame& frame) {
  if (frame_ == tape_.frames.size()) return false;
  const TapeFrame& from = tape_.frames[frame_++];
  frame.stamp = from.stamp;
  frame.pixels = *from.pixels;
  frame.truth = from.truth;
  frame.wheels.clear();
  while (wheel_ < tape_.wheels.size()) {
    frame.wheels.push_back(tape_.wheels[wheel_++]);
    if (frame.wheels.back().stamp >= frame.stamp) break;
  }
  return true;
}

}  // namespace zenith::tools
