#pragma once
// Common landmarks that no frame has shown yet (paper III-C): within the uncertainty that the
// transform enlarges, a similar look makes a pair, and the next fit uses it.

#include "slam/fleet/peer.h"
#include "slam/map/map.h"

namespace zenith {

// Goes on with the walk through the peer's landmarks (Peer::sweep, Peer::swept), a bounded number
// in each call: the hypothesis in `place` gets the pairs that are found.
void search_duplicates(Peer& peer, int place, const Map& map);

}  // namespace zenith
