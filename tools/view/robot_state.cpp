#include "tools/view/robot_state.h"

#include <algorithm>
#include <cmath>

namespace zenith::tools {
namespace {

using nlohmann::json;

// A point of the path for every so much way or turn.
constexpr double kStep_m = 0.03;
constexpr double kTurn_rad = 0.1;
constexpr const char* kLimitsKey = "view";

double seconds_of(const TelemetryLine& line) {
  return static_cast<double>(line.stamp_ns()) * 1e-9;
}

}  // namespace

RobotState::RobotState(std::string label, WriteJpeg write_jpeg)
    : name_(std::move(label)), write_jpeg_(write_jpeg) {}

const TelemetryLine& RobotState::line(const std::string& key) const {
  static const TelemetryLine kNone;
  const auto found = lines_.find(key);
  return found == lines_.end() ? kNone : found->second;
}

void RobotState::set(const std::string& key, TelemetryLine line, std::uint64_t version) {
  lines_[key] = std::move(line);
  versions_[key] = version;
}

void RobotState::drop(const std::string& key, std::uint64_t version) {
  if (lines_.erase(key) > 0) versions_[key] = version;
}

void RobotState::set_link(bool up, const std::string& why, std::uint64_t version) {
  up_ = up;
  set("link", {"link", {{"up", up}, {"why", why}}}, version);
}

void RobotState::clear(std::uint64_t version) {
  std::map<std::string, TelemetryLine> kept;
  for (auto& [key, line] : lines_) {
    versions_[key] = version;
    if (key == "link" || key == kLimitsKey) kept.emplace(key, std::move(line));
  }
  lines_ = std::move(kept);
  seconds_.clear();
  for (auto& [owner, marks] : marks_) marks = {{}, version, version};
  mark_count_ = 0;
  landmarks_version_ = version;
  path_.clear(version);
  steps_.clear(version);
  for (auto& [peer, curve] : confidence_) curve.clear(version);
  picture_.reset();
  rows_there_ = 0;
}

bool RobotState::apply(const TelemetryLine& line, std::uint64_t version) {
  if (const auto* hello = line.as<HelloLine>()) {
    take_hello(line, *hello, version);
  } else if (const auto* pose = line.as<PoseLine>()) {
    take_pose(line, *pose, version);
  } else if (line.as<FiguresLine>() != nullptr) {
    if (line.type() == "health") begin_second(version);
    set(line.type(), line, version);
  } else if (const auto* alignment = line.as<AlignmentLine>()) {
    take_alignment(line, *alignment, version);
  } else if (const auto* peer = line.as<PeerLine>()) {
    if (peer->name.empty()) return false;
    note_peer(peer->name, version);
    const std::string key = "peer/" + peer->name;
    set(key, line, version);
    seconds_[key] = second_;
  } else if (const auto* landmarks = line.as<LandmarksLine>()) {
    take_landmarks(*landmarks, version);
  } else if (const auto* forgotten = line.as<ForgottenLine>()) {
    forget_marks(forgotten->owner, version);
  } else if (const auto* picture = line.as<PictureLine>()) {
    take_picture(line, *picture, version);
  } else if (const auto* strip = line.as<StripLine>()) {
    take_strip(line, *strip, version);
  }
  if (versions_.size() <= lines_.size() + kMostDropped) return false;
  std::erase_if(versions_, [this](const auto& entry) { return lines_.count(entry.first) == 0; });
  return true;
}

void RobotState::count_refused(LineFault fault, std::uint64_t version) {
  ++limits_.refused[static_cast<std::size_t>(fault)];
  show_limits(version);
}

void RobotState::show_limits(std::uint64_t version) {
  json refused = json::object();
  for (std::size_t i = 0; i < kLineFaults; ++i) {
    if (limits_.refused[i] > 0) refused[fault_name(static_cast<LineFault>(i))] = limits_.refused[i];
  }
  set(kLimitsKey,
      {kLimitsKey,
       {{"refused_lines", refused},
        {"full",
         {{"peers_evicted", limits_.peers_evicted},
          {"landmarks_refused", limits_.landmarks_refused}}}}},
      version);
}

// A daemon that began anew has another start frame.
void RobotState::take_hello(const TelemetryLine& line, const HelloLine& hello,
                            std::uint64_t version) {
  const auto* before = this->line("hello").as<HelloLine>();
  if (before == nullptr || before->started_ns != hello.started_ns) clear(version);
  // What was removed meanwhile nobody told: the maps come again.
  for (auto& [owner, marks] : marks_) marks = {{}, version, version};
  mark_count_ = 0;
  landmarks_version_ = version;
  name_ = hello.robot;
  set("hello", line, version);
}

void RobotState::take_pose(const TelemetryLine& line, const PoseLine& pose, std::uint64_t version) {
  const Series<3>::Point& point = pose.pose;
  if (path_.empty() ||
      std::hypot(point[0] - path_.back()[0], point[1] - path_.back()[1]) > kStep_m ||
      std::abs(point[2] - path_.back()[2]) > kTurn_rad) {
    path_.add(point, version);
  }
  if (pose.step_ms) steps_.add({seconds_of(line), *pose.step_ms}, version);
  set("pose", line, version);
}

void RobotState::take_alignment(const TelemetryLine& line, const AlignmentLine& alignment,
                                std::uint64_t version) {
  note_peer(alignment.name, version);
  const std::string key = "alignment/" + alignment.name;
  set(key, line, version);
  seconds_[key] = second_;
  const auto curve = confidence_.try_emplace(alignment.name, kCurvePoints).first;
  if (alignment.confidence) curve->second.add({seconds_of(line), *alignment.confidence}, version);
}

// Who was not told of for the longest time makes room for a new name.
void RobotState::note_peer(const std::string& name, std::uint64_t version) {
  peers_[name] = version;
  if (peers_.size() <= kMostPeers) return;
  const auto oldest =
      std::min_element(peers_.begin(), peers_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const char* kind : {"peer/", "alignment/"}) {
    drop(kind + oldest->first, version);
    seconds_.erase(kind + oldest->first);
  }
  if (confidence_.erase(oldest->first) > 0) versions_["confidence/" + oldest->first] = version;
  peers_.erase(oldest);
  ++limits_.peers_evicted;
  show_limits(version);
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

void RobotState::take_landmarks(const LandmarksLine& landmarks, std::uint64_t version) {
  const std::size_t more = landmarks.rows.size() + landmarks.gone.size();
  if (mark_count_ + more > kMostMarks) drop_gone_marks(version);
  Marks& marks = marks_[landmarks.owner];
  marks.changed = version;
  landmarks_version_ = version;
  const std::uint64_t refused = limits_.landmarks_refused;
  const auto at = [&](std::uint32_t id) -> Mark* {
    const auto found = marks.by_id.find(id);
    if (found != marks.by_id.end()) return &found->second;
    if (mark_count_ >= kMostMarks) return nullptr;
    ++mark_count_;
    return &marks.by_id[id];
  };
  for (const Row& row : landmarks.rows) {
    Mark* mark = at(static_cast<std::uint32_t>(row[0]));
    if (mark == nullptr) {
      ++limits_.landmarks_refused;
    } else {
      *mark = {row, false, version};
    }
  }
  for (const std::uint32_t id : landmarks.gone) {
    Mark* mark = at(id);
    if (mark == nullptr) continue;
    mark->gone = true;
    mark->version = version;
  }
  if (limits_.landmarks_refused != refused) show_limits(version);
}

// Pages get what stays anew.
void RobotState::drop_gone_marks(std::uint64_t version) {
  for (auto& [owner, marks] : marks_) {
    const std::size_t dropped =
        std::erase_if(marks.by_id, [](const auto& entry) { return entry.second.gone; });
    if (dropped == 0) continue;
    mark_count_ -= dropped;
    marks.begun = version;
    for (auto& [id, mark] : marks.by_id) mark.version = version;
  }
}

void RobotState::forget_marks(int owner, std::uint64_t version) {
  Marks& marks = marks_[owner];
  mark_count_ -= marks.by_id.size();
  marks = {{}, version, version};
  landmarks_version_ = version;
}

void RobotState::take_picture(const TelemetryLine& line, const PictureLine& picture,
                              std::uint64_t version) {
  picture_line_ = line;
  picture_size_ = {picture.width, picture.height, std::nullopt};
  grey_.assign(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height),
               0);
  rows_there_ = 0;
  if (picture.jpeg) picture_ = {version, line.shown(), *picture.jpeg};
}

void RobotState::take_strip(const TelemetryLine& line, const StripLine& strip,
                            std::uint64_t version) {
  if (write_jpeg_ == nullptr || picture_line_.empty() ||
      line.stamp_ns() != picture_line_.stamp_ns()) {
    return;
  }
  const int width = picture_size_.width;
  const int height = picture_size_.height;
  if (strip.first_row != rows_there_) return;
  if (strip.grey.size() % static_cast<std::size_t>(width) != 0) return;
  const std::size_t rows = strip.grey.size() / static_cast<std::size_t>(width);
  if (rows < 1 || rows > static_cast<std::size_t>(height - rows_there_)) return;
  std::copy(strip.grey.begin(), strip.grey.end(),
            grey_.begin() + static_cast<std::ptrdiff_t>(rows_there_) * width);
  rows_there_ += static_cast<int>(rows);
  if (rows_there_ < height) return;
  RobotPicture whole;
  whole.serial = version;
  whole.told = picture_line_.shown();
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

std::vector<TelemetryLine> RobotState::as_lines() const {
  std::vector<TelemetryLine> lines;
  const auto add = [&](const std::string& key) {
    if (lines_.count(key) != 0) lines.push_back(lines_.at(key));
  };
  add("hello");
  for (std::size_t i = 0; i < path_.size(); ++i) {
    PoseLine pose;
    pose.pose = path_[i];
    lines.emplace_back("pose", json{{"type", "pose"}, {"pose", path_[i]}}, pose);
  }
  add("health");  // begins the lines of a second
  for (const auto& [key, line] : lines_) {
    if (key != "hello" && key != "health" && key != "link" && key != kLimitsKey) {
      lines.push_back(line);
    }
  }
  for (const auto& [owner, marks] : marks_) {
    lines.emplace_back("landmarks", json{{"type", "landmarks"}, {"peer", owner}},
                       LandmarksLine{owner, landmarks(owner), {}});
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
      out["set"][key] = found->second.shown();
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
