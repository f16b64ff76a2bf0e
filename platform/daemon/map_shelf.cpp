#include "platform/daemon/map_shelf.h"

#include <cmath>
#include <ctime>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "slam/fleet/continued_map.h"

namespace zenith {
namespace {

struct Motion {
  Pose2 T;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // over (x, y, theta)
};

Motion motion_of(const PeerReport& report) {
  const Eigen::Vector3d diagonal(report.variance[0], report.variance[1], report.variance[2]);
  return {report.T_own_peer, diagonal.asDiagonal()};
}

// Of the inverse of a transform: J C J^T.
Motion inverse(const Motion& m) {
  const double c = std::cos(m.T.theta_rad);
  const double s = std::sin(m.T.theta_rad);
  Eigen::Matrix3d J;
  J << -c, -s, s * m.T.x_m - c * m.T.y_m,  //
      s, -c, c * m.T.x_m + s * m.T.y_m,    //
      0.0, 0.0, -1.0;
  return {m.T.inverse(), J * m.covariance * J.transpose()};
}

Motion operator*(const Motion& a, const Motion& b) {
  const Eigen::Vector2d arm = rotation(a.T.theta_rad) * b.T.position();
  Eigen::Matrix3d by_a = Eigen::Matrix3d::Identity();
  by_a(0, 2) = -arm.y();
  by_a(1, 2) = arm.x();
  Eigen::Matrix3d by_b = Eigen::Matrix3d::Identity();
  by_b.topLeftCorner<2, 2>() = rotation(a.T.theta_rad);
  return {a.T * b.T,
          by_a * a.covariance * by_a.transpose() + by_b * b.covariance * by_b.transpose()};
}

// `more`, seen after `map`, comes into it.
void add(std::vector<LandmarkRecord>& map, std::span<const LandmarkRecord> more,
         const Motion& T_map_more) {
  std::vector<LandmarkRecord> all(kMaxLandmarks);
  all.resize(continue_map(map, more, T_map_more.T, T_map_more.covariance, all));
  map = std::move(all);
}

}  // namespace

MapShelf::MapShelf(storage::Folder& folder, const storage::MapHead& head) : head_(head) {
  places_.reserve(kPlaces);
  places_.push_back({storage::MapStore(folder, storage::kMainMap), {}});
  for (const char* name : storage::kSessionMaps) {
    places_.push_back({storage::MapStore(folder, name), {}});
  }
}

std::vector<PastMap> MapShelf::load(bool ours) {
  using Damaged = storage::MapStore::Damaged;
  for (Place& place : places_) {
    const Time start = monotonic_now();
    storage::LoadedMap loaded = place.store.load(ours ? Damaged::kSetAside : Damaged::kLeave);
    log_lines(LogLevel::kWarning, "stored map", loaded.messages);
    if (!loaded.map) continue;
    log_loaded(place, loaded, (monotonic_now() - start).seconds() * 1e3);
    place.disk = Disk::kAsLoaded;
    place.past = std::move(*loaded.map);
  }
  main_ = places_[0].past.landmarks.empty() ? largest(false) : 0;
  choose_own_place();
  std::vector<PastMap> all;
  for (int i = 0; i < kPlaces; ++i) {
    const auto& landmarks = places_[at(i)].past.landmarks;
    if (!landmarks.empty()) all.push_back({slot_of(i), i == 0, landmarks});
  }
  if (all.empty()) log_line(LogLevel::kNotice, "stored map: none yet; a new one begins");
  return all;
}

void MapShelf::log_loaded(const Place& place, const storage::LoadedMap& loaded,
                          double took_ms) const {
  const storage::MapHead& head = loaded.map->head;
  log_line(LogLevel::kNotice,
           "stored %s: %zu landmarks of %s, checkpoint %llu, read in %.0f ms from %s",
           &place == &places_[0] ? "map" : "session's map", loaded.map->landmarks.size(),
           head.robot.c_str(), static_cast<unsigned long long>(head.checkpoint), took_ms,
           loaded.file.c_str());
  if (std::abs(head.camera_height_m - head_.camera_height_m) > 0.05) {
    log_line(LogLevel::kWarning,
             "stored map: made with a camera at %.2f m, this one is at %.2f m: it may not be "
             "recognised",
             head.camera_height_m, head_.camera_height_m);
  }
}

// Of the sessions' maps; `found_ones`: of those in which the robot found itself. -1: there is none.
int MapShelf::largest(bool found_ones) const {
  int best = -1;
  std::size_t most = 0;
  for (int i = 1; i < kPlaces; ++i) {
    const Place& place = places_[at(i)];
    if ((found_ones && place.found == nullptr) || place.past.landmarks.size() <= most) continue;
    most = place.past.landmarks.size();
    best = i;
  }
  return best;
}

// A free one, or that of the smallest session.
void MapShelf::choose_own_place() {
  own_ = 0;
  if (main_ < 0) return;
  for (int i = 1; i < kPlaces; ++i) {
    if (i == main_) continue;
    const std::size_t size = places_[at(i)].past.landmarks.size();
    if (own_ == 0 || size < places_[at(own_)].past.landmarks.size()) own_ = i;
  }
  storage::StoredMap& gone = places_[at(own_)].past;
  if (gone.landmarks.empty()) return;
  log_line(LogLevel::kWarning,
           "stored map: %d sessions are kept that were not found in it yet; the smallest, of %zu "
           "landmarks, gives way to this one",
           kPlaces - 1, gone.landmarks.size());
  gone = {};
}

unsigned MapShelf::found(std::span<const PeerReport> peers) const {
  unsigned bits = 0;
  for (const PeerReport& peer : peers) {
    if (peer.state != AlignmentState::kMerged) continue;
    for (int i = 0; i < kPlaces; ++i) {
      if (peer.peer == slot_of(i) && !places_[at(i)].past.landmarks.empty()) bits |= 1u << i;
    }
  }
  return bits;
}

Status MapShelf::save(std::span<const LandmarkRecord> own, std::span<const PeerReport> peers) {
  for (int i = 0; i < kPlaces; ++i) {
    places_[at(i)].found = nullptr;
    for (const PeerReport& peer : peers) {
      const bool is_found = (found({&peer, 1}) >> i & 1u) != 0;
      if (is_found) places_[at(i)].found = &peer;
    }
  }
  const bool in_main = main_ >= 0 && places_[at(main_)].found != nullptr;
  const int base = in_main ? main_ : largest(true);
  target_ = in_main || main_ < 0 ? 0 : base >= 0 ? base : own_;

  const std::uint64_t number = base >= 0 ? places_[at(base)].past.head.map : head_.map;
  written_.head = head_;
  written_.head.map = number;
  written_.head.saved_s = static_cast<std::int64_t>(std::time(nullptr));
  written_.landmarks = join(own, base);
  // What the target will hold no more goes back to its place before; what lies over a map that was
  // loaded stays there until all of it is in the target.
  if (const Status back = write_back(Disk::kNothing); !back) return back;
  Place& target = places_[at(target_)];
  if (const Status saved = target.store.save(written_); !saved) return saved;
  target.disk = Disk::kWritten;
  if (const Status back = write_back(Disk::kWritten); !back) return back;
  return clear_joined();
}

// Everything that belongs together, the oldest first, in the frame of `base` (-1: of this run).
std::vector<LandmarkRecord> MapShelf::join(std::span<const LandmarkRecord> own, int base) const {
  if (base < 0) return {own.begin(), own.end()};
  const Motion T_base_own = inverse(motion_of(*places_[at(base)].found));
  std::vector<LandmarkRecord> map = places_[at(base)].past.landmarks;
  for (int i = 0; i < kPlaces; ++i) {
    const Place& other = places_[at(i)];
    if (i == base || other.found == nullptr) continue;
    add(map, other.past.landmarks, T_base_own * motion_of(*other.found));
  }
  add(map, own, T_base_own);
  return map;
}

// Maps in which the robot was wrong to find itself, as they were; those whose place holds `now`.
Status MapShelf::write_back(Disk now) {
  for (int i = 0; i < kPlaces; ++i) {
    Place& place = places_[at(i)];
    if (i == target_ || place.found != nullptr || place.past.landmarks.empty()) continue;
    if (place.disk != now) continue;
    storage::StoredMap map = place.past;
    if (const Status saved = place.store.save(map); !saved) return saved;
    place.disk = Disk::kAsLoaded;
  }
  return {};
}

// What is in the target now, or was this run's and is wrong, leaves its place.
Status MapShelf::clear_joined() {
  for (int i = 0; i < kPlaces; ++i) {
    Place& place = places_[at(i)];
    if (i == target_ || place.disk == Disk::kNothing) continue;
    const bool joined = place.found != nullptr;
    const bool was_own = place.past.landmarks.empty() && place.disk == Disk::kWritten;
    if (!joined && !was_own) continue;
    if (const Status removed = place.store.remove(); !removed) return removed;
    place.disk = Disk::kNothing;
  }
  return {};
}

Status MapShelf::leave_main() {
  Place& main = places_[at(main_)];
  if (const Status left = main.store.set_all_aside(); !left) return left;
  main.past = {};
  main.disk = Disk::kNothing;
  main_ = -1;
  return {};
}

std::size_t MapShelf::bytes_written() const {
  std::size_t bytes = 0;
  for (const Place& place : places_) bytes += place.store.bytes_written();
  return bytes;
}

}  // namespace zenith
