#pragma once
// A line of a robot's telemetry (docs/daemon.md), decoded: the one place where what programs on
// other computers, stored timelines and recordings tell is taken apart. Everything behind it works
// with lines that have the right types, bounded sizes, finite numbers and printable texts.
//
// A line of an unknown type is right; keys that are not known stay, within the same bounds.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace zenith::tools {

inline constexpr std::size_t kMostRobots = 64;  // that one program looks at
inline constexpr std::size_t kLongestLine = std::size_t{1} << 20U;
inline constexpr std::size_t kLongestName = 64;  // bytes; zenithd's are at most 32
inline constexpr int kOwnMap = -1;               // owner of the own map; others: a peer's slot
inline constexpr int kMostSlots = 256;           // of peers; zenithd has 80
inline constexpr std::size_t kRowNumbers = 9;
// A landmark: id, x, y, z, xx, xy, yy, zz, observations.
using LandmarkRow = std::array<double, kRowNumbers>;
using PlanarNumbers = std::array<double, 3>;      // x, y, theta
using CovarianceNumbers = std::array<double, 6>;  // xx xy xt yy yt tt

struct HelloLine {
  std::string robot;
  std::int64_t started_ns = 0;
};
struct OdometryNumbers {
  PlanarNumbers pose = {};
  CovarianceNumbers covariance = {};
  PlanarNumbers velocity = {};
  CovarianceNumbers velocity_covariance = {};
};
struct PoseLine {
  PlanarNumbers pose = {};
  std::optional<CovarianceNumbers> covariance;
  std::optional<double> step_ms;
  std::optional<OdometryNumbers> odometry;
};
struct AlignmentLine {
  std::string name;
  std::string state;
  int slot = -1;
  std::optional<PlanarNumbers> pose;
  std::optional<PlanarNumbers> variance;
  std::optional<double> confidence;
};
struct PeerLine {
  std::string name;  // empty: heard, but it has not told its name yet
  int slot = -1;
};
struct LandmarksLine {
  int owner = kOwnMap;
  std::vector<LandmarkRow> rows;
  std::vector<std::uint32_t> gone;
};
struct ForgottenLine {
  int owner = kOwnMap;
};
// A replay's picture is compressed; a daemon's comes in strips.
struct PictureLine {
  int width = 0;
  int height = 0;
  std::optional<std::vector<std::uint8_t>> jpeg;
};
struct StripLine {
  int first_row = 0;
  std::vector<std::uint8_t> grey;
};
// health, verdict, deadlines, radio, stored_map: figures that are shown as they are.
struct FiguresLine {};
struct UnknownLine {};

using LineContent = std::variant<UnknownLine, HelloLine, PoseLine, FiguresLine, AlignmentLine,
                                 PeerLine, LandmarksLine, ForgottenLine, PictureLine, StripLine>;

class TelemetryLine {
 public:
  TelemetryLine() = default;
  // For lines that this program makes by itself.
  TelemetryLine(std::string type, nlohmann::json shown, LineContent content = UnknownLine{});

  // "pose"; empty: there is no line.
  const std::string& type() const { return type_; }
  bool empty() const { return type_.empty(); }
  // Null when it is a line of another kind.
  template <typename Kind>
  const Kind* as() const {
    return std::get_if<Kind>(&content_);
  }
  std::int64_t stamp_ns() const { return stamp_ns_; }  // 0: none
  std::optional<std::int64_t> system_offset_ns() const { return system_offset_ns_; }

  // What a page is shown: the line without landmarks and picture data.
  const nlohmann::json& shown() const { return shown_; }
  // A number or flag (0, 1) at a path such as "/camera/up".
  std::optional<double> number(std::string_view path) const;
  // What is there, as text: "" when there is nothing.
  std::string text(std::string_view path) const;
  // The numbers and flags of the object at a path.
  std::vector<std::pair<std::string, double>> numbers_below(std::string_view path) const;

 private:
  friend class LineDecoder;

  std::string type_;
  nlohmann::json shown_;
  LineContent content_;
  std::int64_t stamp_ns_ = 0;
  std::optional<std::int64_t> system_offset_ns_;
};

enum class LineFault { kTooLong, kTooDeep, kTooMany, kNotJson, kNoType, kWrongField };
inline constexpr std::size_t kLineFaults = 6;
const char* fault_name(LineFault fault);  // "wrong_field"

struct DecodedLine {
  std::optional<TelemetryLine> line;
  LineFault fault = LineFault::kNotJson;  // when there is none
  std::string field;                      // "/pose": whose type or value is wrong
};

DecodedLine decode_telemetry(std::string_view text);
// The same of JSON that a stored timeline holds as a part of its lines.
DecodedLine decode_telemetry_json(nlohmann::json line);

}  // namespace zenith::tools
