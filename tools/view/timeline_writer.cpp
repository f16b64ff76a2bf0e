#include "tools/view/timeline_writer.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "platform/base/base64.h"
#include "platform/daemon/picture_lines.h"
#include "platform/daemon/telemetry_lines.h"
#include "tools/view/timeline.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr Duration kSecond = {1'000'000'000};
constexpr Duration kPictureEvery = {500'000'000};
constexpr int kJpegQuality = 70;
constexpr double kMillimetre = 1e-3;
// A landmark that moved less is not told again.
constexpr double kMoved_m = 5e-3;

double rounded(double value, double step) {
  return std::round(value / step) * step;
}

std::vector<double> row_of(const LandmarkEstimate& l) {
  const auto& p = l.position_m;
  const auto& P = l.covariance_m2;
  std::vector<double> row = {static_cast<double>(l.id)};
  for (const double v : {p.x(), p.y(), p.z()}) row.push_back(rounded(v, kMillimetre));
  for (const double v : {P(0, 0), P(0, 1), P(1, 1), P(2, 2)}) {
    row.push_back(rounded(v, kMillimetre * kMillimetre));
  }
  row.push_back(l.observations);
  return row;
}

// Nobody sees the difference.
bool alike(const std::vector<double>& a, const std::vector<double>& b) {
  const auto deviation = [](const std::vector<double>& row) { return std::sqrt(row[4] + row[6]); };
  return std::hypot(a[1] - b[1], a[2] - b[2]) < kMoved_m &&
         std::abs(deviation(a) - deviation(b)) < kMoved_m;
}

PeerReport report_of(const PeerLog& peer) {
  return {peer.peer,       peer.state,
          peer.T_own_peer, {peer.variance.x(), peer.variance.y(), peer.variance.z()},
          peer.confidence, peer.correspondences};
}

}  // namespace

TimelineWriter::TimelineWriter(const std::filesystem::path& file, std::vector<std::string> robots)
    : file_(file), out_(file, std::ios::binary), robots_(std::move(robots)), told_(robots_.size()) {
  out_ << json({{"timeline", 1}, {"robots", robots_}}).dump() << '\n';
}

void TimelineWriter::put(std::size_t robot, Time stamp, std::string_view line) {
  last_s_ = std::max(last_s_, (stamp - begin_).seconds());
  while (!line.empty() && line.back() == '\n') line.remove_suffix(1);
  if (line.empty()) return;
  out_ << "{\"t_s\":" << last_s_ << ",\"robot\":" << robot << ",\"line\":" << line << "}\n";
}

void TimelineWriter::fill_report(std::size_t robot, const Member& member) {
  const FrameLog& frame = member.last_frame();
  PerceptionReport& r = told_[robot].report;
  r.written = r.stamp = r.last_frame = r.last_wheels = frame.stamp;
  r.camera_up = r.can_up = true;
  note_step(r, member.slam().output());
  r.step = Duration::from_seconds(frame.step_s);
  r.period = Duration::from_seconds(member.frame_period_s());
  r.steps = member.slam().counters();
  r.camera.frames = r.steps.frames;
  r.corners_max = kMaxCorners;
  r.peers.clear();
  for (const PeerLog& peer : frame.peers) r.peers.push_back(report_of(peer));
}

void TimelineWriter::note(std::size_t robot, Member& member) {
  Told& told = told_[robot];
  const Time stamp = member.last_frame().stamp;
  if (!begun_) begin_ = stamp;
  begun_ = true;
  fill_report(robot, member);
  const Duration step = told.report.step;
  told.deadlines->note(step, step, step, told.report.period);
  if (told.report.steps.frames <= 1) {
    JsonLine hello;
    write_hello(hello, robots_[robot], ZENITH_VERSION, "a replay", stamp);
    put(robot, stamp, hello.finish());
    told.next_second = told.next_picture = stamp;
  }
  JsonLine pose;
  write_pose(pose, told.report);
  put(robot, stamp, pose.finish());
  if (stamp >= told.next_second) {
    told.next_second = stamp + kSecond;
    put_second(robot, member);
  }
  if (stamp >= told.next_picture) {
    told.next_picture = stamp + kPictureEvery;
    put_picture(robot, stamp, member);
  }
}

void TimelineWriter::put_second(std::size_t robot, const Member& member) {
  const Told& told = told_[robot];
  const Time stamp = told.report.stamp;
  JsonLine health;
  write_health(health, told.report, judge_health(told.report, {}, begin_, stamp), {});
  put(robot, stamp, health.finish());
  JsonLine deadlines;
  write_deadlines(deadlines, *told.deadlines);
  put(robot, stamp, deadlines.finish());
  for (const PeerReport& peer : told.report.peers) {
    JsonLine line;
    write_alignment(line, peer, robots_[static_cast<std::size_t>(peer.peer)], stamp);
    put(robot, stamp, line.finish());
  }
  put_landmarks(robot, stamp, member);
}

void TimelineWriter::put_landmarks(std::size_t robot, Time stamp, const Member& member) {
  auto& known = told_[robot].landmarks;
  std::map<std::uint32_t, std::vector<double>> now;
  for (const LandmarkEstimate& landmark : member.landmarks()) now[landmark.id] = row_of(landmark);
  json line = {{"type", "landmarks"},
               {"peer", -1},
               {"name", ""},
               {"rows", json::array()},
               {"gone", json::array()}};
  for (auto& [id, row] : now) {
    const auto before = known.find(id);
    if (before != known.end() && alike(before->second, row)) {
      row = before->second;
      continue;
    }
    for (const double number : row) line["rows"].push_back(number);
  }
  for (const auto& [id, row] : known) {
    if (now.count(id) == 0) line["gone"].push_back(id);
  }
  known = std::move(now);
  if (!line["rows"].empty() || !line["gone"].empty()) put(robot, stamp, line.dump());
}

void TimelineWriter::put_picture(std::size_t robot, Time stamp, const Member& member) {
  member.slam().look(*picture_);
  CornersLine corners;
  write_corners(corners, *picture_);
  json line = json::parse(corners.finish());
  const cv::Mat grey(kRectifiedSize, kRectifiedSize, CV_8UC1, picture_->image.data());
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", grey, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  std::string text(base64_size(jpeg.size()), ' ');
  write_base64(jpeg, text.data());
  line["jpeg"] = std::move(text);
  put(robot, stamp, line.dump());
}

Status TimelineWriter::finish() {
  out_.close();
  if (!out_) return Error{file_.string() + ": cannot be written: is the disk full?"};
  return {};
}

}  // namespace zenith::tools
