#pragma once
// A landmark that a peer published, and the pool that all peers' landmarks share.

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "platform/base/arena.h"
#include "slam/capacity.h"
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

// Blocks of kPeerBlock landmarks. One owner at a time for each; nobody's are free.
class PeerLandmarkPool {
 public:
  void layout(Arena& arena) {
    landmarks_ = arena.take<PeerLandmark>(kPeerLandmarkPool);
    free_ = arena.take<std::int16_t>(kPeerBlocks);
    free_count_ = free_.size();
    for (std::size_t i = 0; i < free_.size(); ++i) {
      free_[i] = static_cast<std::int16_t>(free_.size() - 1 - i);
    }
  }

  // A block's number, or -1 when all are taken.
  int take() { return free_count_ == 0 ? -1 : free_[--free_count_]; }
  void give_back(int block) { free_[free_count_++] = static_cast<std::int16_t>(block); }

  std::span<PeerLandmark> block(int number) const {
    return landmarks_.subspan(static_cast<std::size_t>(number) * kPeerBlock, kPeerBlock);
  }
  std::size_t free_blocks() const { return free_count_; }

 private:
  std::span<PeerLandmark> landmarks_;
  std::span<std::int16_t> free_;
  std::size_t free_count_ = 0;
};

}  // namespace zenith
