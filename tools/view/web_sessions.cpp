#include "tools/view/web_sessions.h"

#include <chrono>

#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr JsonLimits kRequestLimits = {4096, 4, 64};
constexpr std::int64_t kPeriod_ns = 100'000'000;

// Viewers show it as a date.
std::int64_t wall_clock_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace

bool PageSession::hear(std::string_view text, std::vector<WebMessage>& out) {
  const ParsedJson asked = parse_bounded(text, kRequestLimits);
  if (!asked.value.is_object()) return false;
  out.push_back({false, answer_(asked.value).dump(-1, ' ', false, json::error_handler_t::replace)});
  return true;
}

bool ViewerSession::hear(std::string_view text, std::vector<WebMessage>& out) {
  (void)out;
  session_.receive(text);
  return true;
}

void ViewerSession::turn(std::vector<WebMessage>& out) {
  if (!greeted_) out.push_back(FoxgloveSession::server_info());
  greeted_ = true;
  const std::int64_t now_ns = wall_clock_ns();
  // The clock may be set back.
  if (now_ns < next_ns_ && next_ns_ - now_ns <= kPeriod_ns) return;
  next_ns_ = now_ns + kPeriod_ns;
  state_.read([&](const std::vector<RobotState>& robots) {
    for (WebMessage& message : session_.turn(now_ns, robots)) out.push_back(std::move(message));
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (session_.wants_picture(i)) state_.wish(i);
    }
  });
}

}  // namespace zenith::tools
