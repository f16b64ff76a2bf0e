#pragma once
// Every capacity of the core, in one place, each derived from who needs it.

#include <cstddef>
#include <cstdint>

namespace zenith {

// The rectified image: 320 x 320 as in the paper (IV).
inline constexpr int kRectifiedSize = 320;

// Corners of one frame: about one per 28 x 28 pixels of the rectified image.
inline constexpr int kMaxCorners = 128;

// A patch is 16 x 16; its compact form keeps 32 DCT coefficients (paper-notes, "Compact NCC").
inline constexpr int kPatchSize = 16;
inline constexpr int kPatchLength = kPatchSize * kPatchSize;
inline constexpr int kCompactLength = 32;

// Particles: 200 by default, 800 for the comparison in the docs.
inline constexpr int kMaxParticles = 1024;

// Landmarks of the own map: 1000 m2 of ceiling at four landmarks a square metre.
inline constexpr int kMaxLandmarks = 4096;

// Looks of one landmark: at most 20, as in the paper (III-A). All landmarks share one pool with
// five for each on average; in simulated buildings they have 3.6 to 4.0. The last ones are kept for
// landmarks that have none yet.
inline constexpr int kMaxAppearances = 20;
inline constexpr int kAppearancePool = 5 * kMaxLandmarks;

// Frames in which landmarks were first seen and that still carry one: 2.7 landmarks each on
// average; in simulated buildings they have 4.1 to 4.3.
inline constexpr int kMaxAnchors = 1216;

// Published landmarks that were removed since peers were last told. More: peers keep them.
inline constexpr int kMaxRemovals = 1024;

// Landmarks predicted into one frame: four times what a frame can show; the newest-seen win.
inline constexpr int kMaxCandidates = 512;

// Wheel samples kept for interpolation: 2 s at 100 Hz and a margin.
inline constexpr int kMaxWheelSamples = 256;

// Peers' maps: of a fleet of 64, and some that were left behind when their robots began anew.
inline constexpr int kMaxPeers = 80;

// Landmarks kept of one peer: as many as it may have itself. All peers share one pool, handed out
// in blocks: eight whole maps and the own one, or 80 of 384 landmarks each and the own one.
inline constexpr int kWholePeerMaps = 8;
inline constexpr int kMaxPeerLandmarks = kMaxLandmarks;
inline constexpr int kPeerBlock = 128;
inline constexpr int kPeerBlocks = 288;
inline constexpr int kPeerLandmarkPool = kPeerBlock * kPeerBlocks;

// Looks of the landmarks of one block: four each on average; simulated robots tell 2.5 to 2.8.
inline constexpr int kPeerBlockLooks = 4 * kPeerBlock;

// The looks of a landmark that travel: six whole records fill a datagram.
inline constexpr int kPublishedAppearances = 7;

// Alignments under test with one peer; pairs of landmarks that hold an alignment. All peers share
// one pool: each may have kMaxHypotheses, and when no more than the reserve is left only
// kFewHypotheses, so that everybody has some: the leader, one under test and a rival.
inline constexpr int kMaxHypotheses = 16;
inline constexpr int kFewHypotheses = 3;
inline constexpr int kHypothesisReserve = (kMaxPeers + 1) * kFewHypotheses;
inline constexpr int kHypothesisPool = 384;
inline constexpr int kMaxCorrespondences = 1024;

// Pairs are kept in blocks: each hypothesis has one of its own, and further ones of a pool. Enough
// for alignments that pair every landmark of all peers, and for 192 blocks of their rivals.
inline constexpr int kPairBlock = 64;
inline constexpr int kPairBlocks = kPeerLandmarkPool / kPairBlock + 192;

// Robots in a joint replay (stacked updates).
inline constexpr int kMaxObservers = 9;

// Robots that this one exchanges maps with at the same time: a fleet of 64.
inline constexpr int kMaxSessions = 63;

// Peers' maps that are followed: those that the core keeps.
inline constexpr int kMaxReplicas = kMaxPeers;

// Own records that can be asked for: all landmarks, and removals that peers may not know yet.
inline constexpr int kMaxOwnRecords = kMaxLandmarks + kMaxRemovals;

// Records of all peers together that are followed by id and revision: 1024 of each robot in a fleet
// of 64. One robot may have as many as the own map has.
inline constexpr int kMaxForeignRecords = 65536;
inline constexpr int kMaxRecordsOfPeer = kMaxOwnRecords;

static_assert(kMaxForeignRecords >= 1024 * kMaxSessions);
static_assert(kMaxForeignRecords >= kPeerLandmarkPool, "as many as the core keeps");
static_assert(kMaxForeignRecords >= kWholePeerMaps * kMaxRecordsOfPeer);
static_assert(kPublishedAppearances <= kMaxAppearances);
static_assert(kAppearancePool >= kMaxLandmarks, "every landmark has at least one look");
static_assert(kPeerBlockLooks >= kPeerBlock, "every landmark has at least one look");
static_assert(kPeerBlockLooks <= INT16_MAX, "PeerLandmark::first_look");
static_assert(kPublishedAppearances <= kPeerBlockLooks - (kPeerBlock - 1));
static_assert(kPeerLandmarkPool >= kWholePeerMaps * kMaxPeerLandmarks + kMaxLandmarks,
              "and the own map, which is searched for repetitions as if it were a peer's");
static_assert(kMaxPeerLandmarks % kPeerBlock == 0);
static_assert(kPeerBlocks >= 3 * kMaxPeers + kMaxLandmarks / kPeerBlock);
static_assert(kMaxCorrespondences % kPairBlock == 0);
static_assert(kHypothesisPool >= kHypothesisReserve + 8 * kMaxHypotheses);
static_assert(kCompactLength < kPatchLength);

}  // namespace zenith
