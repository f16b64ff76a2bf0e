#pragma once
// The page of `zenith view`, of robots that run now or of a replay: everything behind it put
// together.

#include <memory>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/signals.h"
#include "tools/view/history.h"
#include "tools/view/live.h"
#include "tools/view/look_back.h"
#include "tools/view/timeline.h"
#include "tools/view/web_server.h"

namespace zenith::tools {

class LivePage {
 public:
  // Prints where it is. Nothing is heard before turn().
  static Result<std::unique_ptr<LivePage>> start(const WebOptions& options,
                                                 std::vector<RobotAddress> robots);
  // Takes what robots tell within `wait`, or until `wake_fd` can be read (-1: none). One thread.
  void turn(Duration wait, int wake_fd);
  // Robots are no longer listened to: the page says why, and one may look back.
  void end(const std::string& why);
  // "http://127.0.0.1:8765/?token=0123456789abcdef"
  std::string address() const;

 private:
  LivePage(const WebOptions& options, std::vector<RobotAddress> robots);

  const WebOptions options_;
  FleetState state_;
  History history_;
  Live live_;
  LookBack look_back_;
  std::unique_ptr<WebServer> server_;
  Time before_;
  bool ended_ = false;
};

// Plays it on the page until a signal asks to stop.
Status serve_replay(const WebOptions& options, Timeline timeline, Signals& signals);

}  // namespace zenith::tools
