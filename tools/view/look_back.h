#pragma once
// What pages get that look at live robots: the live state, or, to those that ask for it ("past":
// true), an earlier one. All that look back share one moment; the others do not notice.
//
// Called from several threads.

#include <memory>
#include <mutex>

#include <nlohmann/json.hpp>

#include "platform/base/time.h"
#include "tools/view/fleet_state.h"
#include "tools/view/history.h"
#include "tools/view/player.h"

namespace zenith::tools {

class LookBack {
 public:
  static constexpr Duration kAnewAfter = {2'000'000'000};

  // Both must outlive it.
  LookBack(FleetState& live, const History& history) : live_(live), history_(history) {}

  // {"past": true}: what is shown to those that look back; {"control": {"look_back": seconds}}
  // begins anew with all that was told until now, at that moment and paused. Sooner than kAnewAfter
  // it goes there in what it has: reading the history is dear. Others: FleetState::answer().
  nlohmann::json answer(const nlohmann::json& request);
  // So much time has gone by.
  void turn(Duration elapsed);

 private:
  struct Past {
    explicit Past(std::uint64_t epoch, Timeline timeline)
        : state(epoch), player(state, std::move(timeline)) {}
    FleetState state;
    Player player;
  };
  void control(const nlohmann::json& asked);

  FleetState& live_;
  const History& history_;
  std::mutex mutex_;
  std::shared_ptr<Past> past_;
  std::uint64_t epoch_ = 1;
  Duration since_anew_ = kAnewAfter;
};

}  // namespace zenith::tools
