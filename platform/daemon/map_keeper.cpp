#include "platform/daemon/map_keeper.h"

#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "platform/linux/errno_text.h"
#include "platform/linux/log.h"

namespace zenith {

const PeerReport* past_self(const PerceptionReport& report) {
  for (const PeerReport& peer : report.peers) {
    if (peer.peer == kPastSlot && peer.state == AlignmentState::kMerged) return &peer;
  }
  return nullptr;
}

void keep_what_counts(PerceptionReport& report, const MapStatus& status) {
  if (!status.left) return;
  FixedVector<PeerReport, kMaxPeers> others;
  for (const PeerReport& peer : report.peers) {
    if (peer.peer != kPastSlot) others.push_back(peer);
  }
  report.peers = others;
}

std::string state_folder() {
  const char* state = std::getenv("STATE_DIRECTORY");
  if (state == nullptr) return {};
  return {state, std::strcspn(state, ":")};  // systemd lists several so
}

std::string map_folder(const std::string& configured, const std::string& state) {
  if (configured.empty() || configured[0] == '/') return configured;
  if (state.empty()) return {};
  return configured == "." ? state : state + "/" + configured;
}

Status make_map_folder(const std::string& configured, const std::string& state) {
  constexpr mode_t kMode = 0750;
  if (configured.empty() || configured[0] == '/' || state.empty()) return {};
  std::filesystem::path folder = state;
  for (const auto& part : std::filesystem::path(configured)) {
    folder /= part;
    if (::mkdir(folder.c_str(), kMode) == 0 || errno == EEXIST) continue;
    const int error = errno;
    return Error{"map.folder: cannot make " + folder.string() + ": " + errno_text(error) +
                 storage::folder_advice(error)};
  }
  return {};
}

MapKeeper::MapKeeper(storage::Folder& folder, const storage::MapHead& head, Duration interval)
    : folder_(folder),
      self_(storage::this_program(std::string(head.robot.view()))),
      shelf_(folder, head),
      interval_(interval) {}

std::span<const PastMap> MapKeeper::load() {
  const storage::LockTry tried = folder_.lock(self_);
  ours_ = tried.ours();
  if (!ours_) {
    note_failure(tried.why);
  } else if (!tried.why.empty()) {
    log_lines(LogLevel::kWarning, "stored map: " + tried.why);
  }
  if (tried.state != storage::LockTry::State::kOthers) {
    past_ = shelf_.load(ours_);
    loaded_ = looked_for_ = true;
  }
  for (const PastMap& past : past_) {
    const bool is_main = past.slot == kPastSlot;
    if (is_main) told_.past = static_cast<std::uint32_t>(past.landmarks.size());
    told_.sessions += past.whole ? 0 : 1;
  }
  status_.write(told_);
  return past_;
}

bool MapKeeper::take_folder(Time now) {
  if (!ours_ && now < next_try_) return false;
  next_try_ = now + kLockRetry;
  const bool was_ours = ours_;
  const storage::LockTry tried = folder_.lock(self_);
  ours_ = tried.ours();
  if (!ours_) {
    note_failure(tried.why);
    status_.write(told_);
    return false;
  }
  if (was_ours) {
    if (!tried.why.empty()) log_lines(LogLevel::kWarning, "stored map: " + tried.why);
    return true;
  }
  log_line(LogLevel::kNotice, LogFields("map-folder-taken"),
           "stored map: the folder is this program's from here on");
  if (!loaded_) (void)shelf_.load(true);
  loaded_ = true;
  return true;
}

// Told in the log when it is another reason than before.
void MapKeeper::note_failure(const std::string& why) {
  if (!told_.failing || why != told_why_) {
    log_lines(LogLevel::kError, LogFields("map-not-kept"), "the map cannot be kept: " + why);
  }
  told_why_ = why;
  told_.failing = true;
  told_.error.assign(why);
}

void MapKeeper::note(const LandmarkRecord& own) {
  const std::scoped_lock lock(mutex_);
  own_.note(own);
}

void MapKeeper::turn_once(Time now, std::span<const PeerReport> peers) {
  const unsigned found = shelf_.found(peers);
  if (told_.found != shelf_.found_main(found)) {
    told_.found = shelf_.found_main(found);
    status_.write(told_);
  }
  if (take_folder(now) && due(now, found)) save(now, peers);
}

// Copies the own map when it is time for a checkpoint.
bool MapKeeper::due(Time now, unsigned found) {
  if (now < next_) return false;
  const std::scoped_lock lock(mutex_);
  const bool new_ones = own_.members_changed() != members_ || found != found_;
  const bool refined = own_.changed() != changed_ && now >= next_refinement_;
  if (own_.size() == 0 || (!new_ones && !refined)) return false;
  now_ = own_.landmarks();
  changed_now_ = own_.changed();
  members_now_ = own_.members_changed();
  return true;
}

void MapKeeper::finish(Time now, std::span<const PeerReport> peers) {
  next_ = next_refinement_ = next_try_ = now;
  turn_once(now, peers);
}

void MapKeeper::leave_main() {
  log_line(LogLevel::kWarning, LogFields("map-left"),
           "stored map: not recognised, and %zu new landmarks were found: this is another place",
           now_.size());
  const Status left = shelf_.leave_main();
  if (!left) return log_line(LogLevel::kWarning, "stored map: %s", left.error().message.c_str());
  told_.left = true;
  told_.found = false;
  status_.write(told_);  // before anything is told of this run's map as the main one
}

void MapKeeper::save(Time now, std::span<const PeerReport> peers) {
  next_ = now + interval_;
  const unsigned found = shelf_.found(peers);
  const bool not_found = looked_for_ && shelf_.has_main() && !shelf_.found_main(found);
  if (not_found && now_.size() >= kNewMap) leave_main();
  const Status saved = shelf_.save(now_, peers);
  if (saved) {
    changed_ = changed_now_;
    members_ = members_now_;
    found_ = found;
    next_refinement_ = now + Duration{interval_.ns * kRefinementWaits};
    if (told_.failing) {
      log_line(LogLevel::kNotice, LogFields("map-kept-again"),
               "stored map: checkpoints are written again");
    }
    told_.place.assign(shelf_.written_name());
    told_.checkpoint = shelf_.written().head.checkpoint;
    told_.landmarks = static_cast<std::uint32_t>(shelf_.written().landmarks.size());
    told_.last = now;
    ++told_.written;
    told_.failing = false;
    told_.error = {};
  } else {
    ++told_.failed;
    note_failure(saved.error().message);
  }
  told_.bytes = shelf_.bytes_written();
  status_.write(told_);
}

}  // namespace zenith
