#pragma once
// What is known of all robots that are looked at; shared by the thread that listens and those that
// answer pages: each call locks.
//
// A page has a cursor, what it has seen; answers hold what came since. Whoever asks rarely gets
// fewer, larger answers, so that nobody who reads slowly holds anybody up.

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/robot_state.h"

namespace zenith::tools {

class FleetState {
 public:
  // Answers of states with other epochs are told apart by a page that changes between them.
  // `write_jpeg`: RobotState's.
  explicit FleetState(std::uint64_t first_epoch = 1, WriteJpeg write_jpeg = nullptr)
      : write_jpeg_(write_jpeg), epoch_(first_epoch) {}

  // Robots are numbered in the order in which they are added, before anybody reads.
  std::size_t add(const std::string& label);
  std::size_t size() const;

  void apply(std::size_t robot, const TelemetryLine& line);
  // A line came that is none of telemetry's.
  void count_refused(std::size_t robot, LineFault fault);
  void set_link(std::size_t robot, bool up, const std::string& why);
  // Everything is forgotten; lines then build another state (a replay that goes back). Calls of
  // `build` to apply() are within the same lock: nobody sees the half.
  void rebuild(const std::function<void()>& build);
  // Where a replay is, or how far one may look back.
  void set_clock(const nlohmann::json& clock);

  // What a page that says `request` gets: docs/view.md.
  nlohmann::json answer(const nlohmann::json& request);
  // With the lock held.
  void read(const std::function<void(const std::vector<RobotState>&)>& reader) const;

  // Somebody looks at this robot's pictures now.
  void wish(std::size_t robot);
  // Whether somebody did since the last call.
  bool take_wish(std::size_t robot);

 private:
  mutable std::recursive_mutex mutex_;
  const WriteJpeg write_jpeg_;
  std::vector<RobotState> robots_;
  std::vector<bool> wishes_;  // for pictures
  std::uint64_t version_ = 0;
  std::uint64_t epoch_;
  nlohmann::json clock_;
};

}  // namespace zenith::tools
