#pragma once
// A FeatureExtractor in memory of its own.

#include "platform/base/memory_block.h"
#include "slam/features.h"

namespace zenith::tools {

class OwnExtractor {
 public:
  OwnExtractor(const RobotConfig& robot, const Parameters& parameters) : memory_(needed()) {
    Arena arena(memory_.span());
    extractor_.layout(arena);
    extractor_.build(robot, parameters);
  }
  FeatureExtractor& operator*() { return extractor_; }
  FeatureExtractor* operator->() { return &extractor_; }

 private:
  static std::size_t needed() {
    Arena arena;
    FeatureExtractor extractor;
    extractor.layout(arena);
    return arena.used();
  }
  MemoryBlock memory_;
  FeatureExtractor extractor_;
};

}  // namespace zenith::tools
