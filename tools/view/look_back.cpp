#include "tools/view/look_back.h"

#include <algorithm>

#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

// Epochs of one past must not be taken for those of another.
constexpr std::uint64_t kEpochsOfOne = std::uint64_t{1} << 32U;

}  // namespace

void LookBack::control(const json& asked) {
  const auto to_s = read_number(member(asked, "look_back"));
  std::shared_ptr<Past> past;
  bool anew = false;
  std::uint64_t epoch = 0;
  {
    const std::lock_guard lock(mutex_);
    past = past_;
    anew = to_s && (past == nullptr || kAnewAfter <= since_anew_);
    if (anew) {
      since_anew_ = {};
      epoch = epoch_ += kEpochsOfOne;
    }
  }
  if (anew) {
    // Reading the history takes a moment, in which the live state goes on.
    past = std::make_shared<Past>(epoch, history_.timeline());
    const std::lock_guard lock(mutex_);
    past_ = past;
  }
  if (past == nullptr) return;
  past->player.control(to_s ? json{{"seek", *to_s}, {"play", false}} : asked);
}

json LookBack::answer(const json& request) {
  control(member(request, "control"));
  std::shared_ptr<Past> past;
  {
    const std::lock_guard lock(mutex_);
    if (read_flag(member(request, "past")).value_or(false)) past = past_;
  }
  return past ? past->state.answer(request) : live_.answer(request);
}

void LookBack::turn(Duration elapsed) {
  std::shared_ptr<Past> past;
  {
    const std::lock_guard lock(mutex_);
    past = past_;
    since_anew_ = std::min(since_anew_ + elapsed, kAnewAfter);
  }
  if (past) past->player.play(elapsed);
  const double duration_s = history_.duration_s();
  live_.set_clock({{"live", true},
                   {"position_s", duration_s},
                   {"duration_s", duration_s},
                   {"playing", true},
                   {"speed", 1},
                   {"marks", json::array()}});
}

}  // namespace zenith::tools
