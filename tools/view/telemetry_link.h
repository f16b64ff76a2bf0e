#pragma once
// A line to one robot's telemetry: a daemon's socket on this computer, or `zenith telemetry` on
// another one, by ssh. When it breaks it is tried again, once a second.
//
// One thread at a time. poll() waits for fd().

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"
#include "tools/fleet/child_process.h"

namespace zenith::tools {

// Where a robot's telemetry is: "/run/zenith/telemetry.sock", or "ssh:HOST", or
// "ssh:HOST:/path/to/telemetry.sock".
struct RobotAddress {
  std::string host;                // empty: this computer
  std::vector<std::string> paths;  // the first one where a daemon listens; none: the usual places
  std::string text;                // as it was given
};
Result<RobotAddress> parse_robot_address(const std::string& text);
// At most kMostRobots.
Result<std::vector<RobotAddress>> parse_robot_addresses(const std::vector<std::string>& texts);

class TelemetryLink {
 public:
  explicit TelemetryLink(RobotAddress address);
  TelemetryLink(TelemetryLink&&) = default;

  // Opens when it is time, and hands on the lines that are there now, without their ends. True when
  // the state of the link changed.
  bool turn(Time now, const std::function<void(std::string_view)>& take);
  // Asks for pictures during the next seconds.
  void ask_picture();

  bool up() const { return up_; }
  // Why it is not.
  const std::string& why() const { return why_; }
  // To wait for; -1: none now.
  int fd() const { return fd_.get(); }
  const std::string& address() const { return address_.text; }

 private:
  void open();
  void open_local();
  void open_ssh();
  void close(std::string why);
  bool read(const std::function<void(std::string_view)>& take);

  RobotAddress address_;
  UniqueFd fd_;
  std::unique_ptr<ChildProcess> ssh_;
  bool up_ = false;
  std::string why_;
  std::string rest_;  // of a line under way
  Time next_try_;
};

}  // namespace zenith::tools
