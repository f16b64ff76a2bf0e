#include "platform/daemon/map_lines.h"

#include <array>
#include <cmath>

namespace zenith {
namespace {

// Shorter to read, and nobody sees the rest.
double rounded(float value, double step) {
  return std::round(static_cast<double>(value) / step) * step;
}

void append(std::vector<double>& rows, const MapNews& l) {
  constexpr double kMillimetre = 1e-3;
  rows.push_back(l.id);
  for (const float p : l.position_m) rows.push_back(rounded(p, kMillimetre));
  for (const float v : l.variance_m2) rows.push_back(rounded(v, kMillimetre * kMillimetre));
  rows.push_back(l.observations);
}

}  // namespace

void MapLines::note(const MapNews& news) {
  if (news.kind == MapNews::Kind::kForget) return forget(news.owner);
  const Key key = {news.owner, news.id};
  if (news.kind == MapNews::Kind::kRemoved) {
    if (landmarks_.erase(key) > 0) untold_.insert(key);
    return;
  }
  if (landmarks_.size() >= kMostLandmarks && landmarks_.count(key) == 0) return;
  landmarks_[key] = news;
  untold_.insert(key);
}

void MapLines::forget(int owner) {
  const Key first = {owner, 0};
  const Key last = {owner + 1, 0};
  landmarks_.erase(landmarks_.lower_bound(first), landmarks_.lower_bound(last));
  untold_.erase(untold_.lower_bound(first), untold_.lower_bound(last));
  forgotten_.push_back(owner);
}

void MapLines::tell_all() {
  for (const auto& [key, landmark] : landmarks_) untold_.insert(key);
}

void MapLines::tell_nobody() {
  untold_.clear();
  forgotten_.clear();
}

void MapLines::tell(const std::function<const char*(int)>& name_of,
                    const std::function<void(std::string_view)>& send) {
  for (const int owner : forgotten_) {
    JsonLine line;
    line.text("type", "forgotten").number("peer", owner);
    send(line.finish());
  }
  forgotten_.clear();
  for (std::size_t i = 0; i < kLines && !untold_.empty(); ++i) {
    const int owner = untold_.begin()->first;
    std::vector<double> rows;
    std::vector<double> gone;
    std::size_t count = 0;
    while (count < kLineLandmarks && !untold_.empty() && untold_.begin()->first == owner) {
      const Key key = *untold_.begin();
      untold_.erase(untold_.begin());
      ++count;
      const auto found = landmarks_.find(key);
      if (found == landmarks_.end()) {
        gone.push_back(key.second);
      } else {
        append(rows, found->second);
      }
    }
    JsonLine line;
    line.text("type", "landmarks")
        .number("peer", owner)
        .text("name", owner == MapNews::kOwn ? "" : name_of(owner))
        .numbers("rows", rows)
        .numbers("gone", gone);
    send(line.finish());
  }
}

}  // namespace zenith
