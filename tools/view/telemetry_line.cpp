#include "tools/view/telemetry_line.h"

#include <algorithm>
#include <span>

#include "platform/base/base64.h"
#include "platform/base/printable.h"
#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

// Landmarks of a whole map in one line, as a replay writes them, with room.
constexpr JsonLimits kLineLimits = {kLongestLine, 6, 65536};
constexpr std::size_t kLongestText = 512;
constexpr std::size_t kLongestKey = 64;
constexpr std::size_t kMostMembers = 96;
constexpr std::size_t kMostNumbers = 1024;  // of a list that is shown: corners of a picture
constexpr int kLargestSide = 1024;          // of a picture
// Metres, radians and their squares: far beyond any building, and a float holds it.
constexpr double kMostMetres = 1e9;
constexpr double kMostValue = 2e19;  // counters of 64 bits
constexpr std::int64_t kMostTime_ns = 4'000'000'000'000'000'000;

enum class Shape { kNumber, kFlag, kText, kObject, kNumbers3, kNumbers6, kList };

// What the page and others read of a line. Where it is there it has to have this shape; numbers
// may be null, which is how JSON tells those that are none.
struct Field {
  std::string_view line;
  std::string_view path;
  Shape shape;
};
constexpr Field kFields[] = {
    {"hello", "/version", Shape::kText},
    {"hello", "/devices", Shape::kText},
    {"pose", "/covariance", Shape::kNumbers6},
    {"pose", "/map_pose", Shape::kNumbers3},
    {"pose", "/step_ms", Shape::kNumber},
    {"pose", "/period_ms", Shape::kNumber},
    {"pose", "/corners", Shape::kNumber},
    {"pose", "/candidates", Shape::kNumber},
    {"pose", "/matched", Shape::kNumber},
    {"pose", "/inliers", Shape::kNumber},
    {"pose", "/effective_sample_size", Shape::kNumber},
    {"pose", "/odometry", Shape::kObject},
    {"pose", "/odometry/pose", Shape::kNumbers3},
    {"pose", "/odometry/covariance", Shape::kNumbers6},
    {"pose", "/odometry/velocity", Shape::kNumbers3},
    {"pose", "/odometry/velocity_covariance", Shape::kNumbers6},
    {"health", "/state", Shape::kText},
    {"health", "/reason", Shape::kText},
    {"health", "/camera", Shape::kObject},
    {"health", "/camera/up", Shape::kFlag},
    {"health", "/can", Shape::kObject},
    {"health", "/can/up", Shape::kFlag},
    {"health", "/can/bus_off", Shape::kFlag},
    {"health", "/wheels", Shape::kObject},
    {"health", "/map", Shape::kObject},
    {"health", "/load", Shape::kObject},
    {"health", "/page_faults", Shape::kObject},
    {"verdict", "/state", Shape::kText},
    {"verdict", "/reasons", Shape::kObject},
    {"deadlines", "/met", Shape::kNumber},
    {"deadlines", "/missed", Shape::kNumber},
    {"deadlines", "/explained", Shape::kNumber},
    {"deadlines", "/wake_up", Shape::kObject},
    {"deadlines", "/step", Shape::kObject},
    {"deadlines", "/compute", Shape::kObject},
    {"deadlines", "/stolen", Shape::kObject},
    {"deadlines", "/age", Shape::kObject},
    {"radio", "/enabled", Shape::kFlag},
    {"radio", "/open", Shape::kFlag},
    {"radio", "/peers", Shape::kNumber},
    {"radio", "/udp", Shape::kObject},
    {"radio", "/link", Shape::kObject},
    {"radio", "/rejected", Shape::kObject},
    {"radio", "/exchange", Shape::kObject},
    {"alignment", "/state", Shape::kText},
    {"alignment", "/pose", Shape::kNumbers3},
    {"alignment", "/variance", Shape::kNumbers3},
    {"alignment", "/confidence", Shape::kNumber},
    {"alignment", "/correspondences", Shape::kNumber},
    {"peer", "/address", Shape::kText},
    {"peer", "/age_s", Shape::kNumber},
    {"peer", "/complete", Shape::kFlag},
    {"peer", "/landmarks", Shape::kNumber},
    {"peer", "/quarantined", Shape::kFlag},
    {"peer", "/pose", Shape::kNumbers3},
    {"picture", "/used", Shape::kFlag},
    {"picture", "/corners", Shape::kList},
};

bool is_list(const json& value, std::size_t least, std::size_t most, double largest) {
  if (!value.is_array() || value.size() < least || value.size() > most) return false;
  return std::all_of(value.begin(), value.end(), [largest](const json& number) {
    return number.is_null() || read_number(number, -largest, largest);
  });
}

bool has_shape(const json& value, Shape shape) {
  switch (shape) {
    case Shape::kNumber:
      return value.is_null() || value.is_number();
    case Shape::kFlag:
      return value.is_boolean();
    case Shape::kText:
      return value.is_string();
    case Shape::kObject:
      return value.is_object();
    case Shape::kNumbers3:
      return is_list(value, 3, 3, kMostMetres);
    case Shape::kNumbers6:
      return is_list(value, 6, 6, kMostMetres);
    case Shape::kList:
      return is_list(value, 0, kMostNumbers, kMostMetres);
  }
  return false;
}

// Whether whatever is known or not keeps the bounds: what is shown, and forwarded to pages.
bool is_modest(const json& value) {
  switch (value.type()) {
    case json::value_t::string:
      return read_text(value, kLongestText).has_value();
    case json::value_t::number_float:
    case json::value_t::number_integer:
    case json::value_t::number_unsigned:
      return read_number(value, -kMostValue, kMostValue).has_value();
    case json::value_t::array:
      return is_list(value, 0, kMostNumbers, kMostValue);
    case json::value_t::object:
      if (value.size() > kMostMembers) return false;
      for (const auto& [key, inner] : value.items()) {
        if (key.size() > kLongestKey || !is_printable(key) || !is_modest(inner)) return false;
      }
      return true;
    default:
      return true;  // null and flags
  }
}

}  // namespace

// Takes one line apart; the first field that is wrong ends it.
class LineDecoder {
 public:
  explicit LineDecoder(json line) : line_(std::move(line)) {}

  DecodedLine decode() {
    DecodedLine out;
    const auto type = read_text(member(line_, "type"), kLongestKey);
    if (!type || type->empty()) {
      out.fault = line_.is_object() ? LineFault::kNoType : LineFault::kNotJson;
      return out;
    }
    out_.type_ = *type;
    take_content();
    if (wrong_.empty()) check_rest();
    if (!wrong_.empty()) {
      out.fault = LineFault::kWrongField;
      out.field = wrong_;
      return out;
    }
    out_.shown_ = std::move(line_);
    out.line = std::move(out_);
    return out;
  }

 private:
  const json& at(std::string_view path) const { return value_at(line_, path); }
  void fail(std::string_view path) {
    if (wrong_.empty()) wrong_ = path;
  }

  // --- What has to be there.
  std::string name(std::string_view path) {
    auto text = read_text(at(path), kLongestName);
    if (!text) fail(path);
    return text ? std::move(*text) : "";
  }
  std::int64_t integer(std::string_view path, std::int64_t least, std::int64_t most) {
    const auto whole = read_integer(at(path), least, most);
    if (!whole) fail(path);
    return whole.value_or(0);
  }
  // A peer's slot: absent ones and those below 0 are none.
  int slot(std::string_view path) {
    if (at(path).is_null()) return -1;
    return static_cast<int>(integer(path, -1, kMostSlots - 1));
  }
  // Also as a number with a fraction, as programs without 64-bit integers write it.
  std::int64_t time_ns(std::string_view path) {
    if (!at(path).is_number_float()) return integer(path, 0, kMostTime_ns);
    const auto number = read_number(at(path), 0.0, static_cast<double>(kMostTime_ns));
    if (!number) fail(path);
    return static_cast<std::int64_t>(number.value_or(0.0));
  }
  int owner() { return static_cast<int>(integer("/peer", kOwnMap, kMostSlots - 1)); }

  // --- What may be missing; check_rest() looks at its shape.
  template <std::size_t Count>
  std::optional<std::array<double, Count>> numbers(std::string_view path) const {
    return read_numbers<Count>(at(path), kMostMetres);
  }

  void take_content() {
    const std::string& type = out_.type_;
    if (type == "hello") return take_hello();
    if (type == "pose") return take_pose();
    if (type == "alignment") return take_alignment();
    if (type == "peer") return take_peer();
    if (type == "landmarks") return take_landmarks();
    if (type == "forgotten") return void(out_.content_ = ForgottenLine{owner()});
    if (type == "picture") return take_picture();
    if (type == "strip") return take_strip();
    for (const char* figures : {"health", "verdict", "deadlines", "radio", "stored_map"}) {
      if (type == figures) out_.content_ = FiguresLine{};
    }
  }

  void take_hello() {
    HelloLine hello;
    hello.robot = name("/robot");
    if (hello.robot.empty()) fail("/robot");
    if (!at("/started_ns").is_null()) hello.started_ns = time_ns("/started_ns");
    out_.content_ = std::move(hello);
  }

  void take_pose() {
    PoseLine pose;
    const auto place = numbers<3>("/pose");
    if (!place) return fail("/pose");
    pose.pose = *place;
    pose.covariance = numbers<6>("/covariance");
    pose.step_ms = read_number(at("/step_ms"), 0.0, kMostMetres);
    const auto odometry = numbers<3>("/odometry/pose");
    const auto covariance = numbers<6>("/odometry/covariance");
    const auto velocity = numbers<3>("/odometry/velocity");
    const auto velocity_covariance = numbers<6>("/odometry/velocity_covariance");
    if (odometry && covariance && velocity && velocity_covariance) {
      pose.odometry = OdometryNumbers{*odometry, *covariance, *velocity, *velocity_covariance};
    }
    out_.content_ = pose;
  }

  void take_alignment() {
    AlignmentLine alignment;
    alignment.name = name("/name");
    alignment.state = out_text("/state");
    alignment.slot = slot("/peer");
    alignment.pose = numbers<3>("/pose");
    alignment.variance = numbers<3>("/variance");
    alignment.confidence = read_number(at("/confidence"), -kMostMetres, kMostMetres);
    out_.content_ = std::move(alignment);
  }
  std::string out_text(std::string_view path) const {
    return read_text(at(path), kLongestText).value_or("");
  }

  void take_peer() {
    PeerLine peer;
    peer.name = name("/name");
    peer.slot = slot("/peer");
    out_.content_ = std::move(peer);
  }

  void take_landmarks() {
    LandmarksLine landmarks;
    landmarks.owner = owner();
    const json& rows = at("/rows");
    if (!rows.is_array() || rows.size() % kRowNumbers != 0) return fail("/rows");
    for (std::size_t i = 0; i < rows.size(); i += kRowNumbers) {
      LandmarkRow row;
      if (!read_integer(rows[i], 0, UINT32_MAX)) return fail("/rows");
      for (std::size_t k = 0; k < kRowNumbers; ++k) {
        const auto number = read_number(rows[i + k], -kMostMetres * 10, kMostMetres * 10);
        if (!number) return fail("/rows");
        row[k] = *number;
      }
      if (row.back() < 0.0 || row.back() > UINT32_MAX) return fail("/rows");
      landmarks.rows.push_back(row);
    }
    const json& gone = at("/gone");
    if (!gone.is_array()) return fail("/gone");
    for (const json& id : gone) {
      const auto whole = read_integer(id, 0, UINT32_MAX);
      if (!whole) return fail("/gone");
      landmarks.gone.push_back(static_cast<std::uint32_t>(*whole));
    }
    line_.erase("rows");
    line_.erase("gone");
    out_.content_ = std::move(landmarks);
  }

  void take_picture() {
    PictureLine picture;
    picture.width = static_cast<int>(integer("/width", 1, kLargestSide));
    picture.height = static_cast<int>(integer("/height", 1, kLargestSide));
    if (!at("/jpeg").is_null()) {
      picture.jpeg = bytes("/jpeg");
      line_.erase("jpeg");
    }
    out_.content_ = std::move(picture);
  }

  void take_strip() {
    StripLine strip;
    strip.first_row = static_cast<int>(integer("/first_row", 0, kLargestSide));
    strip.grey = bytes("/grey");
    line_.erase("grey");
    out_.content_ = std::move(strip);
  }
  std::vector<std::uint8_t> bytes(std::string_view path) {
    const json& text = at(path);
    std::optional<std::vector<std::uint8_t>> read;
    if (text.is_string()) read = read_base64(text.get_ref<const std::string&>());
    if (!read) fail(path);
    return read ? std::move(*read) : std::vector<std::uint8_t>{};
  }

  void check_rest() {
    if (!at("/stamp_ns").is_null()) out_.stamp_ns_ = time_ns("/stamp_ns");
    if (!at("/system_offset_ns").is_null()) {
      out_.system_offset_ns_ = time_ns("/system_offset_ns");
    }
    for (const Field& field : kFields) {
      if (field.line != out_.type_) continue;
      const json& value = at(field.path);
      if (!value.is_null() && !has_shape(value, field.shape)) return fail(field.path);
    }
    for (const auto& [key, value] : line_.items()) {
      if (key.size() > kLongestKey || !is_printable(key)) return fail("a key");
      if (!is_modest(value)) return fail("/" + key);
    }
    if (line_.size() > kMostMembers) fail("the number of keys");
  }

  json line_;
  TelemetryLine out_;
  std::string wrong_;
};

namespace {

std::optional<double> as_number(const json& value) {
  if (const auto flag = read_flag(value)) return *flag ? 1.0 : 0.0;
  return read_number(value);
}

}  // namespace

TelemetryLine::TelemetryLine(std::string type, json shown, LineContent content)
    : type_(std::move(type)), shown_(std::move(shown)), content_(std::move(content)) {}

std::optional<double> TelemetryLine::number(std::string_view path) const {
  return as_number(value_at(shown_, path));
}

std::string TelemetryLine::text(std::string_view path) const {
  const json& value = value_at(shown_, path);
  if (value.is_null()) return "";
  if (value.is_string()) return value.get_ref<const std::string&>();
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::vector<std::pair<std::string, double>> TelemetryLine::numbers_below(
    std::string_view path) const {
  std::vector<std::pair<std::string, double>> numbers;
  const json& object = value_at(shown_, path);
  if (!object.is_object()) return numbers;
  for (const auto& [key, value] : object.items()) {
    if (const auto found = as_number(value)) numbers.emplace_back(key, *found);
  }
  return numbers;
}

const char* fault_name(LineFault fault) {
  constexpr std::array<const char*, kLineFaults> kNames = {"too_long", "too_deep", "too_many",
                                                           "not_json", "no_type",  "wrong_field"};
  return kNames[static_cast<std::size_t>(fault)];
}

DecodedLine decode_telemetry(std::string_view text) {
  ParsedJson parsed = parse_bounded(text, kLineLimits);
  switch (parsed.fault) {
    case JsonFault::kNone:
      return decode_telemetry_json(std::move(parsed.value));
    case JsonFault::kTooLong:
      return {std::nullopt, LineFault::kTooLong, ""};
    case JsonFault::kTooDeep:
      return {std::nullopt, LineFault::kTooDeep, ""};
    case JsonFault::kTooMany:
      return {std::nullopt, LineFault::kTooMany, ""};
    case JsonFault::kNotJson:
      break;
  }
  return {std::nullopt, LineFault::kNotJson, ""};
}

DecodedLine decode_telemetry_json(json line) {
  return LineDecoder(std::move(line)).decode();
}

}  // namespace zenith::tools
