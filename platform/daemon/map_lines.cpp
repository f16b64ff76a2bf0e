#include "platform/daemon/map_lines.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "platform/daemon/json_line.h"

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

std::string landmarks_line(std::span<const MapNews> news, const MapLines::NameOf& name_of) {
  std::vector<double> rows;
  std::vector<double> gone;
  for (const MapNews& one : news) {
    if (one.kind == MapNews::Kind::kRemoved) {
      gone.push_back(one.id);
    } else {
      append(rows, one);
    }
  }
  const int owner = news.front().owner;
  JsonLine line;
  line.text("type", "landmarks")
      .number("peer", owner)
      .text("name", owner == MapNews::kOwn ? "" : name_of(owner))
      .numbers("rows", rows)
      .numbers("gone", gone);
  return std::string(line.finish());
}

}  // namespace

void MapLines::note(const MapNews& news) {
  const std::scoped_lock lock(mutex_);
  if (news.kind == MapNews::Kind::kForget) return forget(news.owner);
  const Key key = {news.owner, news.id};
  const auto known = landmarks_.find(key);
  if (known == landmarks_.end()) {
    const bool is_new = news.kind == MapNews::Kind::kLandmark;
    if (!is_new || landmarks_.size() >= kMostLandmarks) return;
  } else {
    changes_.erase(known->second);
  }
  if (news.kind == MapNews::Kind::kRemoved) {
    landmarks_.erase(known);
    return add_gone(news);
  }
  changes_[++last_] = news;
  landmarks_[key] = last_;
}

void MapLines::add_gone(const MapNews& news) {
  changes_[++last_] = news;
  gone_[last_] = {news.owner, news.id};
  if (gone_.size() <= kMostGone) return;
  oldest_known_ = gone_.begin()->first;
  changes_.erase(oldest_known_);
  gone_.erase(gone_.begin());
}

void MapLines::forget(int owner) {
  const auto first = landmarks_.lower_bound({owner, 0});
  const auto last = landmarks_.lower_bound({owner + 1, 0});
  for (auto at = first; at != last; ++at) changes_.erase(at->second);
  landmarks_.erase(first, last);
  for (auto at = gone_.begin(); at != gone_.end();) {
    if (at->second.first == owner) {
      changes_.erase(at->first);
      at = gone_.erase(at);
    } else {
      ++at;
    }
  }
  if (const auto before = forgotten_.find(owner); before != forgotten_.end()) {
    changes_.erase(before->second);
  }
  MapNews news;
  news.owner = owner;
  news.kind = MapNews::Kind::kForget;
  changes_[++last_] = news;
  forgotten_[owner] = last_;
}

// False when something before was dropped.
bool MapLines::copy(const MapPlace& from, MapPlace& end, std::vector<MapNews>& out) const {
  const std::scoped_lock lock(mutex_);
  end = from;
  if (from.joined == 0) end.joined = last_;
  // What went away before the reader came it has never seen; only that may it miss.
  if (end.joined < oldest_known_ && from.seen < oldest_known_) return false;
  auto at = changes_.upper_bound(from.seen);
  for (; at != changes_.end() && out.size() < kBatchLandmarks; ++at) {
    end.seen = at->first;
    const bool shows = at->second.kind == MapNews::Kind::kLandmark || at->first > end.joined;
    if (shows) out.push_back(at->second);
  }
  end.joined = std::max(end.joined, end.seen);  // readers that are equally far are alike
  return true;
}

void MapLines::next(const MapPlace& from, const NameOf& name_of, MapBatch& out) const {
  std::vector<MapNews> news;
  news.reserve(kBatchLandmarks);
  out.lines.clear();
  out.is_too_far_behind = !copy(from, out.end, news);
  // A map that was forgotten comes before what is in its place now.
  std::stable_sort(news.begin(), news.end(), [](const MapNews& a, const MapNews& b) {
    return std::pair(a.owner, a.kind != MapNews::Kind::kForget) <
           std::pair(b.owner, b.kind != MapNews::Kind::kForget);
  });
  const std::span<const MapNews> all(news);
  for (std::size_t i = 0; i < all.size();) {
    if (all[i].kind == MapNews::Kind::kForget) {
      JsonLine line;
      line.text("type", "forgotten").number("peer", all[i++].owner);
      out.lines.emplace_back(line.finish());
      continue;
    }
    std::size_t count = 1;
    while (count < kLineLandmarks && i + count < all.size() &&
           all[i + count].owner == all[i].owner) {
      ++count;
    }
    out.lines.push_back(landmarks_line(all.subspan(i, count), name_of));
    i += count;
  }
}

std::size_t MapLines::size() const {
  const std::scoped_lock lock(mutex_);
  return landmarks_.size();
}

}  // namespace zenith
