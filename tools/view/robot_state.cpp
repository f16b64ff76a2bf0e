#include "tools/view/robot_state.h"

#include <cmath>

#include "platform/base/base64.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

// A point of the path for every so much way or turn.
constexpr double kStep_m = 0.03;
constexpr double kTurn_rad = 0.1;
constexpr int kLargestSide = 4096;

double seconds_of(const json& line) {
  return line.value("stamp_ns", 0.0) * 1e-9;
}

bool is_numbers(const json& value, std::size_t count) {
  if (!value.is_array() || value.size() != count) return false;
  for (const json& number : value) {
    if (!number.is_number()) return false;
  }
  return true;
}

json value_or_empty(const json& line, const char* key) {
  const auto found = line.find(key);
  return found == line.end() ? json() : *found;
}

}  // namespace

RobotState::RobotState(std::string label, WriteJpeg write_jpeg)
    : name_(std::move(label)), write_jpeg_(write_jpeg) {}

const json& RobotState::line(const std::string& key) const {
  static const json kNone;
  const auto found = lines_.find(key);
  return found == lines_.end() ? kNone : found->second;
}

void RobotState::set(const std::string& key, json value, std::uint64_t version) {
  lines_[key] = std::move(value);
  versions_[key] = version;
}

void RobotState::drop(const std::string& key, std::uint64_t version) {
  if (lines_.erase(key) > 0) versions_[key] = version;
}

void RobotState::set_link(bool up, const std::string& why, std::uint64_t version) {
  up_ = up;
  set("link", {{"up", up}, {"why", why}}, version);
}

void RobotState::clear(std::uint64_t version) {
  const json link = line("link");
  for (const auto& [key, value] : lines_) versions_[key] = version;
  lines_.clear();
  if (!link.is_null()) set("link", link, version);
  seconds_.clear();
  for (auto& [owner, marks] : marks_) marks = {{}, version, version};
  landmarks_version_ = version;
  path_.clear(version);
  steps_.clear(version);
  for (auto& [peer, curve] : confidence_) curve.clear(version);
  picture_.reset();
  rows_there_ = 0;
}

bool RobotState::apply(const json& line, std::uint64_t version) {
  if (!line.is_object() || !line.contains("type") || !line["type"].is_string()) return false;
  try {
    const std::string type = line["type"];
    if (type == "hello") {
      take_hello(line, version);
    } else if (type == "pose") {
      take_pose(line, version);
    } else if (type == "health") {
      begin_second(version);
      set(type, line, version);
    } else if (type == "deadlines" || type == "radio") {
      set(type, line, version);
    } else if (type == "alignment") {
      take_alignment(line, version);
    } else if (type == "peer") {
      const std::string name = line.at("name").get<std::string>();
      if (name.empty()) return true;  // heard, but it has not told its name yet
      const std::string key = "peer/" + name;
      set(key, line, version);
      seconds_[key] = second_;
    } else if (type == "landmarks") {
      take_landmarks(line, version);
    } else if (type == "forgotten") {
      marks_[line.at("peer").get<int>()] = {{}, version, version};
      landmarks_version_ = version;
    } else if (type == "picture") {
      take_picture(line, version);
    } else if (type == "strip") {
      take_strip(line, version);
    }
  } catch (const json::exception&) {
    return false;  // a key has another type than telemetry's
  }
  return true;
}

// A daemon that began anew has another start frame.
void RobotState::take_hello(const json& line, std::uint64_t version) {
  const json& before = this->line("hello");
  const bool same = before.is_object() &&
                    value_or_empty(before, "started_ns") == value_or_empty(line, "started_ns");
  if (!same) clear(version);
  // What was removed meanwhile nobody told: the maps come again.
  for (auto& [owner, marks] : marks_) marks = {{}, version, version};
  landmarks_version_ = version;
  name_ = line.at("robot").get<std::string>();
  set("hello", line, version);
}

void RobotState::take_pose(const json& line, std::uint64_t version) {
  const json& pose = line.at("pose");
  if (!is_numbers(pose, 3)) return;
  const Series<3>::Point point = {pose[0], pose[1], pose[2]};
  if (path_.empty() ||
      std::hypot(point[0] - path_.back()[0], point[1] - path_.back()[1]) > kStep_m ||
      std::abs(point[2] - path_.back()[2]) > kTurn_rad) {
    path_.add(point, version);
  }
  if (line.contains("step_ms") && line["step_ms"].is_number()) {
    steps_.add({seconds_of(line), line["step_ms"].get<double>()}, version);
  }
  set("pose", line, version);
}

void RobotState::take_alignment(const json& line, std::uint64_t version) {
  const std::string peer = line.at("name").get<std::string>();
  const std::string key = "alignment/" + peer;
  set(key, line, version);
  seconds_[key] = second_;
  const auto curve = confidence_.try_emplace(peer, kCurvePoints).first;
  if (value_or_empty(line, "confidence").is_number()) {
    curve->second.add({seconds_of(line), line["confidence"].get<double>()}, version);
  }
}

// `health` begins the lines of a second: an alignment or peer that the last one did not have is no
// more.
void RobotState::begin_second(std::uint64_t version) {
  std::vector<std::string> ended;
  for (const auto& [key, second] : seconds_) {
    if (second < second_) ended.push_back(key);
  }
  for (const std::string& key : ended) {
    drop(key, version);
    seconds_.erase(key);
  }
  ++second_;
}

void RobotState::take_landmarks(const json& line, std::uint64_t version) {
  Marks& marks = marks_[line.at("peer").get<int>()];
  marks.changed = version;
  const json& rows = line.at("rows");
  for (std::size_t i = 0; i + kRowNumbers <= rows.size(); i += kRowNumbers) {
    Mark mark;
    mark.version = version;
    for (std::size_t k = 0; k < kRowNumbers; ++k) mark.row[k] = rows[i + k].get<double>();
    marks.by_id[rows[i].get<std::uint32_t>()] = mark;
  }
  for (const json& id : line.at("gone")) {
    Mark& mark = marks.by_id[id.get<std::uint32_t>()];
    mark.gone = true;
    mark.version = version;
  }
  landmarks_version_ = version;
}

// A replay's picture is compressed; a daemon's comes in strips.
void RobotState::take_picture(const json& line, std::uint64_t version) {
  const int width = line.at("width").get<int>();
  const int height = line.at("height").get<int>();
  if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide) return;
  picture_line_ = line;
  grey_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  rows_there_ = 0;
  if (!line.contains("jpeg")) return;
  const auto jpeg = read_base64(line["jpeg"].get<std::string>());
  if (!jpeg) return;
  picture_line_.erase("jpeg");
  picture_ = {version, picture_line_, *jpeg};
}

void RobotState::take_strip(const json& line, std::uint64_t version) {
  if (write_jpeg_ == nullptr || !picture_line_.is_object() ||
      line.at("stamp_ns") != picture_line_.at("stamp_ns")) {
    return;
  }
  const auto bytes = read_base64(line.at("grey").get<std::string>());
  const int width = picture_line_.at("width").get<int>();
  const int height = picture_line_.at("height").get<int>();
  const int row = line.at("first_row").get<int>();
  if (!bytes || row != rows_there_ || bytes->size() % static_cast<std::size_t>(width) != 0) return;
  const int rows = static_cast<int>(bytes->size()) / width;
  if (rows < 1 || row + rows > height) return;
  std::copy(bytes->begin(), bytes->end(), grey_.begin() + static_cast<std::ptrdiff_t>(row) * width);
  rows_there_ += rows;
  if (rows_there_ < height) return;
  RobotPicture whole;
  whole.serial = version;
  whole.told = picture_line_;
  whole.jpeg = write_jpeg_(width, height, grey_);
  picture_ = std::move(whole);
}

std::vector<RobotState::Row> RobotState::landmarks(int owner) const {
  std::vector<Row> rows;
  const auto found = marks_.find(owner);
  if (found == marks_.end()) return rows;
  for (const auto& [id, mark] : found->second.by_id) {
    if (!mark.gone) rows.push_back(mark.row);
  }
  return rows;
}

std::vector<json> RobotState::as_lines() const {
  std::vector<json> lines;
  const auto add = [&](const std::string& key) {
    if (lines_.count(key) != 0) lines.push_back(lines_.at(key));
  };
  add("hello");
  for (std::size_t i = 0; i < path_.size(); ++i) {
    lines.push_back({{"type", "pose"}, {"pose", path_[i]}});
  }
  add("health");  // begins the lines of a second
  for (const auto& [key, line] : lines_) {
    if (key != "hello" && key != "health" && key != "link") lines.push_back(line);
  }
  for (const auto& [owner, marks] : marks_) {
    json rows = json::array();
    for (const Row& row : landmarks(owner)) {
      for (const double number : row) rows.push_back(number);
    }
    lines.push_back(
        {{"type", "landmarks"}, {"peer", owner}, {"rows", rows}, {"gone", json::array()}});
  }
  return lines;
}

std::uint64_t RobotState::landmarks_version(int owner) const {
  const auto found = marks_.find(owner);
  return found == marks_.end() ? 0 : found->second.changed;
}

json RobotState::changes(std::uint64_t version) const {
  json out;
  for (const auto& [key, changed] : versions_) {
    if (changed <= version) continue;
    const auto found = lines_.find(key);
    if (found == lines_.end()) {
      out["drop"].push_back(key);
    } else {
      out["set"][key] = found->second;
    }
  }
  if (landmarks_version_ > version) {
    for (const auto& [owner, marks] : marks_) {
      json map;
      if (marks.begun > version) map["clear"] = true;
      for (const auto& [id, mark] : marks.by_id) {
        if (mark.version <= version) continue;
        if (mark.gone) {
          map["gone"].push_back(id);
        } else {
          map["rows"].push_back(mark.row);
        }
      }
      if (!map.is_null()) out["maps"][std::to_string(owner)] = std::move(map);
    }
  }
  if (path_.changed_since(version)) out["path"] = path_.since(version);
  if (steps_.changed_since(version)) out["steps"] = steps_.since(version);
  for (const auto& [peer, curve] : confidence_) {
    if (curve.changed_since(version)) out["confidence"][peer] = curve.since(version);
  }
  return out;
}

}  // namespace zenith::tools
