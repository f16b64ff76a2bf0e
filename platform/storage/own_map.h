#pragma once
// The own map as it was last published, landmark by landmark: what a checkpoint is made of. One
// thread. Bounded by what the core has: kMaxOwnRecords.

#include <cstdint>
#include <map>
#include <vector>

#include "slam/capacity.h"
#include "slam/fleet/record.h"

namespace zenith::storage {

class OwnMap {
 public:
  void note(const LandmarkRecord& record) {
    const bool known = landmarks_.count(record.id) != 0;
    if (record.removed) {
      landmarks_.erase(record.id);
      if (known) ++members_changed_;
    } else if (known || landmarks_.size() < std::size_t{kMaxOwnRecords}) {
      landmarks_[record.id] = record;
      if (!known) ++members_changed_;
    }
    ++changed_;
  }

  // In rising id.
  std::vector<LandmarkRecord> landmarks() const {
    std::vector<LandmarkRecord> all;
    all.reserve(landmarks_.size());
    for (const auto& [id, record] : landmarks_) all.push_back(record);
    return all;
  }
  std::size_t size() const { return landmarks_.size(); }
  // How often anything changed, and how often a landmark came or went.
  std::uint64_t changed() const { return changed_; }
  std::uint64_t members_changed() const { return members_changed_; }

 private:
  std::map<std::uint32_t, LandmarkRecord> landmarks_;
  std::uint64_t changed_ = 0;
  std::uint64_t members_changed_ = 0;
};

}  // namespace zenith::storage
