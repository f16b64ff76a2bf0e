#pragma once
// What speaks over the page's WebSockets: the page itself, and viewers of Foxglove's protocol.

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/fleet_state.h"
#include "tools/view/foxglove_session.h"
#include "tools/view/web_connection.h"

namespace zenith::tools {

// A number that an object holds up by one for as long as it lives.
class Counted {
 public:
  explicit Counted(std::size_t& count) : count_(count) { ++count_; }
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::size_t& count_;
};

// /live: each text is a request, each answer a state.
class PageSession final : public WebSession {
 public:
  using Answer = std::function<nlohmann::json(const nlohmann::json& request)>;
  // `open` counts the sessions; both must outlive it.
  PageSession(const Answer& answer, std::size_t& open) : answer_(answer), open_(open) {}
  bool hear(std::string_view text, std::vector<WebMessage>& out) override;
  void turn(std::vector<WebMessage>& out) override { (void)out; }

 private:
  const Answer& answer_;
  const Counted open_;
};

class ViewerSession final : public WebSession {
 public:
  ViewerSession(FleetState& state, std::size_t& open) : state_(state), open_(open) {}
  bool hear(std::string_view text, std::vector<WebMessage>& out) override;
  void turn(std::vector<WebMessage>& out) override;

 private:
  FleetState& state_;
  const Counted open_;
  FoxgloveSession session_;
  bool greeted_ = false;
  std::int64_t next_ns_ = 0;
};

}  // namespace zenith::tools
