#pragma once
// A landmark that a peer published, and the pool that all peers' landmarks share: blocks of
// kPeerBlock landmarks with their looks.

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
  std::int16_t first_look = 0;  // in its block
  std::int16_t look_count = 0;

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

// Landmarks with room for kPeerBlockLooks looks, which lie one after the other. Full of them: a
// landmark gets fewer than it asks for, the first always.
class PeerLandmarkBlock {
 public:
  void clear();

  PeerLandmark& operator[](int i) { return landmarks_[static_cast<std::size_t>(i)]; }
  const PeerLandmark& operator[](int i) const { return landmarks_[static_cast<std::size_t>(i)]; }
  std::span<const PeerAppearance> looks(int i) const {
    const PeerLandmark& l = (*this)[i];
    return std::span(looks_).subspan(static_cast<std::size_t>(l.first_look),
                                     static_cast<std::size_t>(l.look_count));
  }
  // Room for so many looks of landmark `i`, or for fewer: to be written by the caller. Looks of
  // others move, O(kPeerBlock).
  std::span<PeerAppearance> make_looks(int i, int count);

 private:
  std::array<PeerLandmark, kPeerBlock> landmarks_;
  std::array<PeerAppearance, kPeerBlockLooks> looks_;
  int looks_used_ = 0;
};

// One owner at a time for each block; nobody's are free.
class PeerLandmarkPool {
 public:
  void layout(Arena& arena) {
    blocks_ = arena.take<PeerLandmarkBlock>(kPeerBlocks);
    free_ = arena.take<std::int16_t>(kPeerBlocks);
    free_count_ = free_.size();
    for (std::size_t i = 0; i < free_.size(); ++i) {
      free_[i] = static_cast<std::int16_t>(free_.size() - 1 - i);
    }
  }

  // An empty block's number, or -1 when all are taken.
  int take() {
    if (free_count_ == 0) return -1;
    const int number = free_[--free_count_];
    block(number).clear();
    return number;
  }
  void give_back(int block) { free_[free_count_++] = static_cast<std::int16_t>(block); }

  PeerLandmarkBlock& block(int number) const { return blocks_[static_cast<std::size_t>(number)]; }
  std::size_t free_blocks() const { return free_count_; }

 private:
  std::span<PeerLandmarkBlock> blocks_;
  std::span<std::int16_t> free_;
  std::size_t free_count_ = 0;
};

}  // namespace zenith
