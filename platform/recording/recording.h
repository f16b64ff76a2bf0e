#pragma once
// Reading a recording: a folder as it is described in layout.h.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/clock_log.h"
#include "platform/recording/frame_list.h"
#include "platform/recording/ground_truth.h"
#include "platform/recording/robot_file.h"
#include "platform/recording/source.h"
#include "platform/recording/wheel_queue.h"

namespace zenith {

struct ReadOptions {
  double max_odometry_gap_s = 0.5;       // longer holes while frames go on are told
  bool skip_damaged = false;             // frames that are missing or damaged: leave out, not stop
  Duration wheels_late;                  // taken from the wheels' stamps
  bool wheels_from_first_frame = false;  // the wheels begin with the first frame, whatever they say
  bool pixels = true;  // false: stamps, wheels and truth alone; files are not opened
};

// Everything but the frames is read, and checked, when it is opened.
class Recording : public Source {
 public:
  static Result<std::unique_ptr<Recording>> open(const std::filesystem::path& folder,
                                                 const ReadOptions& options);

  // What a recording in `folder` is called: as the folder.
  static std::string name_of(const std::filesystem::path& folder);

  const std::string& name() const override { return name_; }
  const RobotConfig& config() const override { return config_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  Result<bool> next(SourceFrame& frame) override;

  const std::filesystem::path& folder() const { return folder_; }
  Time first_stamp() const { return frames_.front().stamp; }
  Time last_stamp() const { return frames_.back().stamp; }
  // Where the clock of its stamps lies; empty when the recording does not say.
  const std::optional<ClockLog>& clock() const { return clock_; }
  const std::vector<StampedPose>& truth() const { return truth_; }
  // What was taken from the wheels' stamps.
  Duration wheels_moved() const { return wheels_moved_; }
  // What was odd but no reason to stop, a line each; complete at the end.
  std::vector<std::string> warnings() const;

 private:
  Recording() = default;

  Status load_description();
  Status load_odometry(const RobotFile& robot);
  Status move_wheels(std::vector<WheelSample>& samples, const std::filesystem::path& path);
  Status check_files();
  Status read_pixels(const ListedFrame& listed, std::vector<std::uint8_t>& pixels) const;

  std::filesystem::path folder_;
  std::string name_;
  RobotConfig config_;
  ReadOptions options_;
  std::vector<ListedFrame> frames_;
  std::vector<StampedPose> truth_;
  std::optional<ClockLog> clock_;
  std::size_t position_ = 0;
  WheelQueue wheels_;
  Duration wheels_moved_;
  std::vector<std::string> warnings_;
  std::size_t skipped_ = 0;
  std::string first_skipped_;
};

}  // namespace zenith
