#pragma once
// One peer's published map as this robot keeps it: the highest revision of each landmark.
// Removed landmarks are remembered, so that a late record does not bring them back, until their
// room is needed. Full of present ones: new landmarks are rejected and counted.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "platform/base/arena.h"
#include "slam/fleet/record.h"
#include "slam/image/patch.h"

namespace zenith {

struct PeerAppearance {
  CompactPatch compact;
  float direction_rad = 0.0F;  // in the peer's frame
};

struct PeerLandmark {
  std::uint32_t id = 0;
  std::uint32_t revision = 0;
  bool present = false;  // false: removed by the peer; its slot may become another landmark's
  float x_m = 0.0F;      // in the peer's frame
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::array<float, 6> covariance_m2 = {};
  int observations = 0;
  int appearance_count = 0;
  std::array<PeerAppearance, kPublishedAppearances> appearances;

  Eigen::Vector2d xy() const { return {x_m, y_m}; }
  Eigen::Matrix2d covariance_xy() const {
    return (Eigen::Matrix2d() << covariance_m2[0], covariance_m2[1], covariance_m2[1],
            covariance_m2[3])
        .finished();
  }
  Eigen::Matrix3d covariance() const {
    const auto& c = covariance_m2;
    return (Eigen::Matrix3d() << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]).finished();
  }
};

class PeerMap {
 public:
  void layout(Arena& arena);

  // False when the record was refused: not finite, absurd, or no room.
  bool apply(const LandmarkRecord& record);

  std::span<const PeerLandmark> landmarks() const { return landmarks_.first(count_); }
  const PeerLandmark& operator[](int slot) const {
    return landmarks_[static_cast<std::size_t>(slot)];
  }
  bool empty() const { return count_ == 0; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  static constexpr std::size_t kBuckets = 2 * kMaxPeerLandmarks;  // open addressing, half full
  static std::size_t home_of(std::uint32_t id) {
    return (id * 2654435761U) % kBuckets;  // Knuth's multiplicative hash
  }
  std::size_t bucket(std::uint32_t id) const;  // where it stands, or the free one where it would
  PeerLandmark* enter(std::uint32_t id);
  void forget(std::uint32_t id);

  std::span<PeerLandmark> landmarks_;
  std::span<std::int32_t> slot_of_;  // bucket -> slot + 1, 0: free
  std::size_t count_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace zenith
