#pragma once
// Writes a run of a team as a timeline (timeline.h): what each robot's daemon would have told.

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/daemon/deadlines.h"
#include "platform/daemon/perception_report.h"
#include "slam/picture.h"
#include "tools/runner/member.h"

namespace zenith::tools {

class TimelineWriter {
 public:
  // `robots` by their index in the team.
  TimelineWriter(const std::filesystem::path& file, std::vector<std::string> robots);

  // The robot has stepped. In the order of time.
  void note(std::size_t robot, Member& member);
  // Whether all was written.
  Status finish();

 private:
  struct Told {
    PerceptionReport report;
    std::unique_ptr<Deadlines> deadlines = std::make_unique<Deadlines>();
    std::map<std::uint32_t, std::vector<double>> landmarks;  // the row of each
    Time next_second;
    Time next_picture;
  };

  void put(std::size_t robot, Time stamp, std::string_view line);
  void put_second(std::size_t robot, const Member& member);
  void put_landmarks(std::size_t robot, Time stamp, const Member& member);
  void put_picture(std::size_t robot, Time stamp, const Member& member);
  void fill_report(std::size_t robot, const Member& member);

  const std::filesystem::path file_;
  std::ofstream out_;
  const std::vector<std::string> robots_;
  std::vector<Told> told_;
  bool begun_ = false;
  Time begin_;
  double last_s_ = 0.0;
  const std::unique_ptr<Picture> picture_ = std::make_unique<Picture>();
};

}  // namespace zenith::tools
