#pragma once
// Plays a timeline into the state of the robots, as fast as asked, from any moment on.
//
// play() and control() are called from several threads.

#include <mutex>

#include <nlohmann/json.hpp>

#include "platform/base/time.h"
#include "tools/view/fleet_state.h"
#include "tools/view/timeline.h"

namespace zenith::tools {

class Player {
 public:
  // `state` must outlive it; the timeline's robots are added. Plays at once.
  Player(FleetState& state, Timeline timeline);

  // So much time has gone by.
  void play(Duration elapsed);
  // {"seek": seconds}, {"play": bool}, {"speed": factor}; others are passed over.
  void control(const nlohmann::json& asked);

  double position_s() const { return position_s_; }

 private:
  void seek(double to_s);
  void advance(double to_s);
  void tell_clock();

  FleetState& state_;
  const Timeline timeline_;
  std::mutex mutex_;
  bool begun_ = false;
  std::size_t next_ = 0;  // entry
  double position_s_ = 0.0;
  double speed_ = 1.0;
  bool playing_ = true;
};

}  // namespace zenith::tools
