#pragma once
// Points in the order in which they came, for those who have seen the older ones. Bounded: when it
// is full every second point goes, and everybody gets it anew.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

namespace zenith::tools {

template <std::size_t Numbers>
class Series {
 public:
  using Point = std::array<double, Numbers>;

  explicit Series(std::size_t most) : most_(most) {}

  // `version` rises.
  void add(const Point& point, std::uint64_t version) {
    if (points_.size() >= most_) thin(version);
    points_.push_back({point, version});
  }
  void clear(std::uint64_t version) {
    points_.clear();
    begun_ = version;
  }
  bool empty() const { return points_.empty(); }
  std::size_t size() const { return points_.size(); }
  const Point& back() const { return points_.back().numbers; }
  const Point& operator[](std::size_t i) const { return points_[i].numbers; }

  bool changed_since(std::uint64_t version) const {
    return begun_ > version || (!points_.empty() && points_.back().version > version);
  }
  // {"from": index of the first, "points": [[..], ..]}: what came after `version`.
  nlohmann::json since(std::uint64_t version) const {
    std::size_t from = points_.size();
    if (begun_ > version) {
      from = 0;
    } else {
      while (from > 0 && points_[from - 1].version > version) --from;
    }
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = from; i < points_.size(); ++i) list.push_back(points_[i].numbers);
    return {{"from", from}, {"points", std::move(list)}};
  }

 private:
  struct Entry {
    Point numbers;
    std::uint64_t version;
  };

  void thin(std::uint64_t version) {
    for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
    points_.resize((points_.size() + 1) / 2);
    begun_ = version;
  }

  std::size_t most_;
  std::vector<Entry> points_;
  std::uint64_t begun_ = 0;
};

}  // namespace zenith::tools
