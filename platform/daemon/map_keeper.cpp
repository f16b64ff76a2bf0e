#include "platform/daemon/map_keeper.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "slam/fleet/continued_map.h"

namespace zenith {
namespace {

// Of the inverse of a transform whose variances are these: J C J^T.
Eigen::Matrix3d inverse_covariance(const Pose2& T, const std::array<double, 3>& variance) {
  const double c = std::cos(T.theta_rad);
  const double s = std::sin(T.theta_rad);
  Eigen::Matrix3d J;
  J << -c, -s, s * T.x_m - c * T.y_m,  //
      s, -c, c * T.x_m + s * T.y_m,    //
      0.0, 0.0, -1.0;
  const Eigen::Vector3d diagonal(variance[0], variance[1], variance[2]);
  return J * diagonal.asDiagonal() * J.transpose();
}

}  // namespace

const PeerReport* past_self(const PerceptionReport& report) {
  for (const PeerReport& peer : report.peers) {
    if (peer.peer == kPastSlot && peer.state == AlignmentState::kMerged) return &peer;
  }
  return nullptr;
}

std::string map_folder(const std::string& configured) {
  if (configured.empty() || configured[0] == '/') return configured;
  const char* state = std::getenv("STATE_DIRECTORY");
  if (state == nullptr || *state == '\0') return {};
  const std::string first(state, std::strcspn(state, ":"));  // systemd lists several so
  return configured == "." ? first : first + "/" + configured;
}

MapKeeper::MapKeeper(storage::Folder& folder, const storage::MapHead& head, Duration interval)
    : store_(folder), interval_(interval) {
  map_.head = head;
}

std::span<const LandmarkRecord> MapKeeper::load() {
  const Time start = monotonic_now();
  storage::LoadedMap loaded = store_.load();
  for (const std::string& message : loaded.messages) {
    log_line(LogLevel::kWarning, "stored map: %s", message.c_str());
  }
  if (!loaded.map) {
    log_line(LogLevel::kNotice, "stored map: none yet; a new one begins");
  } else {
    past_ = std::move(loaded.map->landmarks);
    told_.checkpoint = loaded.map->head.checkpoint;
    told_.past = static_cast<std::uint32_t>(past_.size());
    const double height_m = map_.head.camera_height_m;
    const std::string robot = loaded.map->head.robot.c_str();
    map_.head.map = loaded.map->head.map;
    log_line(LogLevel::kNotice,
             "stored map: %zu landmarks of %s, checkpoint %llu, read in %.0f ms from %s",
             past_.size(), robot.c_str(), static_cast<unsigned long long>(told_.checkpoint),
             (monotonic_now() - start).seconds() * 1e3, loaded.file.c_str());
    if (std::abs(loaded.map->head.camera_height_m - height_m) > 0.05) {
      log_line(LogLevel::kWarning,
               "stored map: made with a camera at %.2f m, this one is at %.2f m: it may not be "
               "recognised",
               loaded.map->head.camera_height_m, height_m);
    }
  }
  told_.map = map_.head.map;
  status_.write(told_);
  return past_;
}

void MapKeeper::note(const LandmarkRecord& own) {
  const std::scoped_lock lock(mutex_);
  own_.note(own);
}

void MapKeeper::turn_once(Time now, const PeerReport* past) {
  if (told_.found != (past != nullptr)) {
    told_.found = past != nullptr;
    status_.write(told_);
  }
  if (due(now)) save(now, past);
}

// Copies the own map when it is time for a checkpoint.
bool MapKeeper::due(Time now) {
  if (now < next_) return false;
  const std::scoped_lock lock(mutex_);
  const bool new_ones = own_.members_changed() != members_;
  const bool refined = own_.changed() != changed_ && now >= next_refinement_;
  if (own_.size() == 0 || (!new_ones && !refined)) return false;
  now_ = own_.landmarks();
  changed_now_ = own_.changed();
  members_now_ = own_.members_changed();
  return true;
}

void MapKeeper::finish(Time now, const PeerReport* past) {
  next_ = next_refinement_ = now;
  turn_once(now, past);
}

void MapKeeper::leave_past(Time now) {
  log_line(LogLevel::kWarning,
           "stored map: not recognised, and %zu new landmarks were found: this is another place",
           now_.size());
  const Status left = store_.set_all_aside();
  if (!left) log_line(LogLevel::kWarning, "stored map: %s", left.error().message.c_str());
  past_.clear();
  map_.head.map = static_cast<std::uint64_t>(now.ns) * 0x9E3779B97F4A7C15U;
  told_.map = map_.head.map;
}

std::vector<LandmarkRecord> MapKeeper::to_write(const PeerReport* past) const {
  if (past == nullptr) return now_;
  std::vector<LandmarkRecord> all(kMaxLandmarks);
  all.resize(continue_map(past_, now_, past->T_own_peer.inverse(),
                          inverse_covariance(past->T_own_peer, past->variance), all));
  return all;
}

void MapKeeper::save(Time now, const PeerReport* past) {
  next_ = now + interval_;
  if (past == nullptr && !past_.empty()) {
    if (now_.size() < kNewMap) return;  // it may still find itself
    leave_past(now);
  }
  map_.landmarks = to_write(past_.empty() ? nullptr : past);
  map_.head.saved_s = static_cast<std::int64_t>(std::time(nullptr));
  const Status saved = store_.save(map_);
  if (saved) {
    changed_ = changed_now_;
    members_ = members_now_;
    next_refinement_ = now + Duration{interval_.ns * kRefinementWaits};
    if (told_.failing) log_line(LogLevel::kNotice, "stored map: checkpoints are written again");
    told_.checkpoint = map_.head.checkpoint;
    told_.landmarks = static_cast<std::uint32_t>(map_.landmarks.size());
    told_.last = now;
    ++told_.written;
    told_.error = {};
  } else {
    ++told_.failed;
    if (saved.error().message != told_.error.view()) {
      log_line(LogLevel::kError, "the map cannot be kept: %s", saved.error().message.c_str());
    }
    told_.error.assign(saved.error().message);
  }
  told_.failing = !saved;
  told_.bytes = store_.bytes_written();
  status_.write(told_);
}

}  // namespace zenith
