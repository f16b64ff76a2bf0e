#pragma once
// Writes what running daemons tell as a timeline (timeline.h), in a thread of its own.

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "platform/base/result.h"
#include "tools/view/telemetry_link.h"

namespace zenith::tools {

class TimelineRecorder {
 public:
  // The robots' names in the order of their addresses. Listens until finish(), or its end.
  TimelineRecorder(const std::filesystem::path& file, std::vector<std::string> names,
                   std::vector<RobotAddress> robots);
  ~TimelineRecorder() { (void)finish(); }
  TimelineRecorder(const TimelineRecorder&) = delete;
  TimelineRecorder& operator=(const TimelineRecorder&) = delete;

  // Whether all was written.
  Status finish();

 private:
  void run(std::vector<std::string> names, std::vector<RobotAddress> robots);

  const std::filesystem::path file_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> failed_ = false;
  std::thread thread_;
};

}  // namespace zenith::tools
