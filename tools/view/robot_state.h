#pragma once
// What is known of one robot, from the lines of its telemetry (docs/daemon.md), and what of it a
// page that has seen an older state must be told.
//
// Coordinates are the robot's own start frame, those of a peer's map the peer's. Not for several
// threads at a time.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/view/series.h"

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
  // Landmarks of one map: id, x, y, z, xx, xy, yy, zz, observations.
  static constexpr std::size_t kRowNumbers = 9;
  using Row = std::array<double, kRowNumbers>;
  static constexpr int kOwn = -1;  // the owner of the own map; others: a peer's slot

  // `label` stands for the name until the robot tells it. Without `write_jpeg` a live robot has no
  // picture.
  explicit RobotState(std::string label, WriteJpeg write_jpeg = nullptr);

  // One line. `version` rises with each call of any of the following. Lines and keys that are not
  // known are passed over; false when it is none of telemetry's.
  bool apply(const nlohmann::json& line, std::uint64_t version);
  // Whether somebody at the other end tells, or why not.
  void set_link(bool up, const std::string& why, std::uint64_t version);
  // As when nothing was heard yet.
  void clear(std::uint64_t version);

  const std::string& name() const { return name_; }
  bool up() const { return up_; }
  // The last line of this type ("pose"), of a peer ("alignment/bert", "peer/bert"); null: none.
  const nlohmann::json& line(const std::string& key) const;
  const std::map<std::string, nlohmann::json>& lines() const { return lines_; }
  // Lines that make another one what this one is, but for its curves.
  std::vector<nlohmann::json> as_lines() const;
  // The landmarks of an owner that are there now.
  std::vector<Row> landmarks(int owner) const;
  const Series<3>& path() const { return path_; }
  const std::optional<RobotPicture>& picture() const { return picture_; }
  std::uint64_t landmarks_version() const { return landmarks_version_; }
  // Rises with each change of this owner's; 0: never told.
  std::uint64_t landmarks_version(int owner) const;

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

  void set(const std::string& key, nlohmann::json value, std::uint64_t version);
  void drop(const std::string& key, std::uint64_t version);
  void take_hello(const nlohmann::json& line, std::uint64_t version);
  void take_pose(const nlohmann::json& line, std::uint64_t version);
  void take_alignment(const nlohmann::json& line, std::uint64_t version);
  void take_landmarks(const nlohmann::json& line, std::uint64_t version);
  void take_strip(const nlohmann::json& line, std::uint64_t version);
  void take_picture(const nlohmann::json& line, std::uint64_t version);
  void begin_second(std::uint64_t version);

  std::string name_;
  WriteJpeg write_jpeg_;
  bool up_ = false;
  std::map<std::string, nlohmann::json> lines_;
  std::map<std::string, std::uint64_t> versions_;  // of lines, of those that are no more, too
  std::map<std::string, std::uint64_t> seconds_;   // when a line that may stop coming came last
  std::uint64_t second_ = 0;
  std::map<int, Marks> marks_;
  std::uint64_t landmarks_version_ = 0;
  Series<3> path_{kPathPoints};
  Series<2> steps_{kCurvePoints};
  std::map<std::string, Series<2>> confidence_;
  std::optional<RobotPicture> picture_;
  nlohmann::json picture_line_;  // under way
  std::vector<unsigned char> grey_;
  int rows_there_ = 0;
};

}  // namespace zenith::tools
