#pragma once
// Holds decoded wheel samples until the frame that they belong to comes by.

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "slam/wheels.h"

namespace zenith {

class WheelQueue {
 public:
  // In the order of their stamps.
  void push(const WheelSample& sample) { waiting_.push_back(sample); }

  // True when a sample at or after `stamp` is there: the travel up to it can be interpolated.
  bool covers(Time stamp) const { return !waiting_.empty() && waiting_.back().stamp >= stamp; }

  // Moves all samples up to the first at or after `stamp` into `out`.
  void take(Time stamp, std::vector<WheelSample>& out) {
    out.clear();
    while (!waiting_.empty()) {
      const WheelSample sample = waiting_.front();
      waiting_.pop_front();
      out.push_back(sample);
      if (sample.stamp >= stamp) return;
    }
  }

 private:
  std::deque<WheelSample> waiting_;
};

}  // namespace zenith
