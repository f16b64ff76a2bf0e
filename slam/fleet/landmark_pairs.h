#pragma once
// The pairs of landmarks that a hypothesis keeps: the first kPairBlock in place, further ones in
// blocks of a pool that all hypotheses share. Most have few; the right alignment of a large map
// has many. Full, or no block free: rejects.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "platform/base/arena.h"
#include "platform/base/ensure.h"
#include "slam/capacity.h"

namespace zenith {

struct LandmarkPair {
  std::int32_t own_slot = -1;
  std::uint32_t own_id = 0;
  std::int32_t peer_slot = -1;
  std::uint32_t peer_id = 0;
  std::int32_t seen = 0;  // frames that confirmed the pair
};

class PairPool {
 public:
  void layout(Arena& arena) {
    pairs_ = arena.take<LandmarkPair>(static_cast<std::size_t>(kPairBlocks) * kPairBlock);
    free_ = arena.take<std::int16_t>(kPairBlocks);
    free_count_ = free_.size();
    for (std::size_t i = 0; i < free_.size(); ++i) {
      free_[i] = static_cast<std::int16_t>(free_.size() - 1 - i);
    }
  }

  // A block of kPairBlock pairs, or null when all are taken.
  LandmarkPair* take() {
    return free_count_ == 0 ? nullptr : &pairs_[kPairBlock * at(free_[--free_count_])];
  }
  void give_back(LandmarkPair* block) {
    free_[free_count_++] = static_cast<std::int16_t>((block - pairs_.data()) / kPairBlock);
  }
  std::size_t free_blocks() const { return free_count_; }

 private:
  static std::size_t at(std::int16_t i) { return static_cast<std::size_t>(i); }
  std::span<LandmarkPair> pairs_;
  std::span<std::int16_t> free_;
  std::size_t free_count_ = 0;
};

class PairList {
 public:
  PairList() = default;  // without a pool, for kPairBlock pairs
  PairList(const PairList&) = delete;
  PairList& operator=(const PairList&) = delete;
  void use(PairPool& pool) { pool_ = &pool; }

  bool push_back(const LandmarkPair& pair);
  // Order is not kept: the last pair takes the place of the removed one.
  void swap_remove(std::size_t i) {
    ensure(i < size_, "PairList: no such pair to remove");
    (*this)[i] = (*this)[size_ - 1];
    --size_;
  }
  // Gives all blocks back. Whoever gives up the list calls it: blocks have no other owner.
  void clear();

  std::size_t size() const { return size_; }
  LandmarkPair& operator[](std::size_t i) {
    ensure(i < size_, "PairList: index beyond the end");
    return i < kPairBlock ? first_[i] : further_[i / kPairBlock - 1][i % kPairBlock];
  }
  const LandmarkPair& operator[](std::size_t i) const {
    ensure(i < size_, "PairList: index beyond the end");
    return i < kPairBlock ? first_[i] : further_[i / kPairBlock - 1][i % kPairBlock];
  }

  class Iterator {
   public:
    Iterator(const PairList& list, std::size_t i) : list_(&list), i_(i) {}
    const LandmarkPair& operator*() const { return (*list_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    bool operator==(const Iterator&) const = default;

   private:
    const PairList* list_;
    std::size_t i_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }

 private:
  static constexpr std::size_t kFurther = kMaxCorrespondences / kPairBlock - 1;

  std::size_t size_ = 0;
  std::size_t blocks_ = 0;  // of further_; kept until clear()
  PairPool* pool_ = nullptr;
  std::array<LandmarkPair, kPairBlock> first_;
  std::array<LandmarkPair*, kFurther> further_ = {};
};

inline bool PairList::push_back(const LandmarkPair& pair) {
  if (size_ == kPairBlock * (blocks_ + 1)) {
    LandmarkPair* block = pool_ == nullptr || blocks_ == kFurther ? nullptr : pool_->take();
    if (block == nullptr) return false;
    further_[blocks_++] = block;
  }
  ++size_;
  (*this)[size_ - 1] = pair;
  return true;
}

inline void PairList::clear() {
  while (blocks_ > 0) pool_->give_back(further_[--blocks_]);
  size_ = 0;
}

}  // namespace zenith
