#include "slam/fleet/peer_landmark.h"

#include <algorithm>
#include <cassert>

namespace zenith {

void PeerLandmarkBlock::clear() {
  landmarks_.fill({});
  looks_used_ = 0;
}

std::span<PeerAppearance> PeerLandmarkBlock::make_looks(int i, int count) {
  PeerLandmark& l = (*this)[i];
  int kept_for_others = 0;  // their first looks
  for (const PeerLandmark& other : landmarks_) {
    kept_for_others += &other != &l && other.look_count == 0 ? 1 : 0;
  }
  const int of_others = looks_used_ - l.look_count;
  const int given = std::clamp(kPeerBlockLooks - of_others - kept_for_others, 0, count);
  assert(count == 0 || given > 0);
  if (l.look_count == 0) l.first_look = static_cast<std::int16_t>(looks_used_);

  // Whatever lies behind moves up or down.
  const int end = l.first_look + l.look_count;
  const int shift = given - l.look_count;
  const auto from = looks_.begin() + end;
  const auto to = looks_.begin() + looks_used_;
  if (shift < 0) std::copy(from, to, from + shift);
  if (shift > 0) std::copy_backward(from, to, to + shift);
  for (PeerLandmark& other : landmarks_) {
    if (&other == &l || other.look_count == 0 || other.first_look < end) continue;
    other.first_look = static_cast<std::int16_t>(other.first_look + shift);
  }
  looks_used_ += shift;
  l.look_count = static_cast<std::int16_t>(given);
  return std::span(looks_).subspan(static_cast<std::size_t>(l.first_look),
                                   static_cast<std::size_t>(given));
}

}  // namespace zenith
