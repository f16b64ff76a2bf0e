#include "tools/view/look_back.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

// Epochs of one past must not be taken for those of another.
constexpr std::uint64_t kEpochsOfOne = std::uint64_t{1} << 32U;

}  // namespace

void LookBack::control(const json& asked) {
  if (!asked.is_object()) return;
  if (asked.contains("look_back") && asked["look_back"].is_number()) {
    // Reading the history takes a moment, in which others get their answers.
    Timeline timeline = history_.timeline();
    std::uint64_t epoch = 0;
    {
      const std::lock_guard lock(mutex_);
      epoch = epoch_ += kEpochsOfOne;
    }
    auto past = std::make_shared<Past>(epoch, std::move(timeline));
    past->player.control({{"seek", asked["look_back"]}, {"play", false}});
    const std::lock_guard lock(mutex_);
    past_ = std::move(past);
    return;
  }
  std::shared_ptr<Past> past;
  {
    const std::lock_guard lock(mutex_);
    past = past_;
  }
  if (past) past->player.control(asked);
}

json LookBack::answer(const json& request) {
  if (request.contains("control")) control(request["control"]);
  std::shared_ptr<Past> past;
  {
    const std::lock_guard lock(mutex_);
    if (request.value("past", false)) past = past_;
  }
  return past ? past->state.answer(request) : live_.answer(request);
}

void LookBack::turn(Duration elapsed) {
  std::shared_ptr<Past> past;
  {
    const std::lock_guard lock(mutex_);
    past = past_;
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
