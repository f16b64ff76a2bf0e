#include "platform/daemon/map_keeper.h"

#include <cstdlib>
#include <cstring>

#include "platform/linux/log.h"

namespace zenith {

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
    : shelf_(folder, head), interval_(interval) {}

std::span<const PastMap> MapKeeper::load() {
  past_ = shelf_.load();
  for (const PastMap& past : past_) {
    const bool is_main = past.slot == kPastSlot;
    if (is_main) told_.past = static_cast<std::uint32_t>(past.landmarks.size());
    told_.sessions += past.whole ? 0 : 1;
  }
  status_.write(told_);
  return past_;
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
  if (due(now, found)) save(now, peers);
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
  next_ = next_refinement_ = now;
  turn_once(now, peers);
}

void MapKeeper::leave_main() {
  log_line(LogLevel::kWarning, LogFields("map-left"),
           "stored map: not recognised, and %zu new landmarks were found: this is another place",
           now_.size());
  const Status left = shelf_.leave_main();
  if (!left) log_line(LogLevel::kWarning, "stored map: %s", left.error().message.c_str());
}

void MapKeeper::save(Time now, std::span<const PeerReport> peers) {
  next_ = now + interval_;
  const unsigned found = shelf_.found(peers);
  if (shelf_.has_main() && !shelf_.found_main(found) && now_.size() >= kNewMap) leave_main();
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
    told_.error = {};
  } else {
    ++told_.failed;
    if (saved.error().message != told_.error.view()) {
      log_line(LogLevel::kError, LogFields("map-not-kept"), "the map cannot be kept: %s",
               saved.error().message.c_str());
    }
    told_.error.assign(saved.error().message);
  }
  told_.failing = !saved;
  told_.bytes = shelf_.bytes_written();
  status_.write(told_);
}

}  // namespace zenith
