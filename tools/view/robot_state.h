#pragma once
// What is known of one robot, from the lines of its telemetry (telemetry_line.h), and what of it a
// page that has seen an older state must be told.
//
// Coordinates are the robot's own start frame, those of a peer's map the peer's. Not for several
// threads at a time.
//
// Bounded, whatever is told: of peers' names the longest silent one goes when there are too many,
// landmarks without room are counted, and so are lines that could not be read. `zenith view` shows
// the counts as the line "view" and as metrics.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/series.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {

// A picture that is whole.
struct RobotPicture {
  std::uint64_t serial = 0;  // another one for each
  nlohmann::json told;       // the line `picture`
  std::vector<unsigned char> jpeg;
};

// Compresses a grey picture, row by row from its top.
using WriteJpeg = std::vector<unsigned char> (*)(int width, int height,
                                                 const std::vector<unsigned char>& grey);

class RobotState {
 public:
  static constexpr std::size_t kPathPoints = 8000;
  static constexpr std::size_t kCurvePoints = 3600;
  static constexpr std::size_t kMostPeers = 96;     // names; zenithd has 80 slots
  static constexpr std::size_t kMostMarks = 65536;  // landmarks of all maps; zenithd has 40960
  static constexpr std::size_t kMostDropped = 4 * kMostPeers;  // keys that are no more
  static constexpr std::size_t kRowNumbers = tools::kRowNumbers;
  using Row = LandmarkRow;
  static constexpr int kOwn = kOwnMap;

  // `label` stands for the name until the robot tells it. Without `write_jpeg` a live robot has no
  // picture.
  explicit RobotState(std::string label, WriteJpeg write_jpeg = nullptr);

  // One line. `version` rises with each call of any of the following. True when a page that has
  // seen an older state must get all anew.
  bool apply(const TelemetryLine& line, std::uint64_t version);
  // What came was no line of telemetry.
  void count_refused(LineFault fault, std::uint64_t version);
  // Whether somebody at the other end tells, or why not.
  void set_link(bool up, const std::string& why, std::uint64_t version);
  // As when nothing was heard yet.
  void clear(std::uint64_t version);

  const std::string& name() const { return name_; }
  bool up() const { return up_; }
  // The last line of this type ("pose"), of a peer ("alignment/bert", "peer/bert"); empty: none.
  const TelemetryLine& line(const std::string& key) const;
  const std::map<std::string, TelemetryLine>& lines() const { return lines_; }
  // Lines that make another one what this one is, but for its curves.
  std::vector<TelemetryLine> as_lines() const;
  // The landmarks of an owner that are there now.
  std::vector<Row> landmarks(int owner) const;
  const Series<3>& path() const { return path_; }
  const std::optional<RobotPicture>& picture() const { return picture_; }
  std::uint64_t landmarks_version() const { return landmarks_version_; }
  // Rises with each change of this owner's; 0: never told.
  std::uint64_t landmarks_version(int owner) const;

  struct Limits {
    std::array<std::uint64_t, kLineFaults> refused = {};  // lines, by LineFault
    std::uint64_t peers_evicted = 0;
    std::uint64_t landmarks_refused = 0;
  };
  const Limits& limits() const { return limits_; }

  // What is new since `version`; see docs/view.md. Empty when nothing is.
  nlohmann::json changes(std::uint64_t version) const;

 private:
  struct Mark {
    Row row = {};
    bool gone = false;
    std::uint64_t version = 0;
  };
  struct Marks {
    std::map<std::uint32_t, Mark> by_id;
    std::uint64_t begun = 0;
    std::uint64_t changed = 0;
  };

  void set(const std::string& key, TelemetryLine line, std::uint64_t version);
  void drop(const std::string& key, std::uint64_t version);
  void take_hello(const TelemetryLine& line, const HelloLine& hello, std::uint64_t version);
  void take_pose(const TelemetryLine& line, const PoseLine& pose, std::uint64_t version);
  void take_alignment(const TelemetryLine& line, const AlignmentLine& alignment,
                      std::uint64_t version);
  void take_landmarks(const LandmarksLine& landmarks, std::uint64_t version);
  void forget_marks(int owner, std::uint64_t version);
  void take_strip(const TelemetryLine& line, const StripLine& strip, std::uint64_t version);
  void take_picture(const TelemetryLine& line, const PictureLine& picture, std::uint64_t version);
  void begin_second(std::uint64_t version);
  void note_peer(const std::string& name, std::uint64_t version);
  void drop_gone_marks(std::uint64_t version);
  void show_limits(std::uint64_t version);

  std::string name_;
  WriteJpeg write_jpeg_;
  bool up_ = false;
  std::map<std::string, TelemetryLine> lines_;
  std::map<std::string, std::uint64_t> versions_;  // of lines, of those that are no more, too
  std::map<std::string, std::uint64_t> seconds_;   // when a line that may stop coming came last
  std::map<std::string, std::uint64_t> peers_;     // the version at which each was last told of
  std::uint64_t second_ = 0;
  std::map<int, Marks> marks_;
  std::size_t mark_count_ = 0;  // of all owners, with those that are gone
  std::uint64_t landmarks_version_ = 0;
  Series<3> path_{kPathPoints};
  Series<2> steps_{kCurvePoints};
  std::map<std::string, Series<2>> confidence_;
  std::optional<RobotPicture> picture_;
  TelemetryLine picture_line_;  // under way
  PictureLine picture_size_;
  std::vector<unsigned char> grey_;
  int rows_there_ = 0;
  Limits limits_;
};

}  // namespace zenith::tools
