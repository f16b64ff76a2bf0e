#include "tools/view/history.h"

namespace zenith::tools {
namespace {

constexpr Duration kPictureEvery = {1'000'000'000};
constexpr std::size_t kEntryBytes = 96;  // besides its text

}  // namespace

void History::add(const std::string& label) {
  const std::lock_guard lock(mutex_);
  before_.emplace_back(label);
  kept_.emplace_back(kPictureEvery);
}

void History::note(std::size_t robot, const RobotState& state, const TelemetryLine& line,
                   std::string_view text, Time now) {
  const std::lock_guard lock(mutex_);
  std::string kept = kept_[robot].take(state, line, text, now);
  if (kept.empty()) return;
  bytes_ += kept.size() + kEntryBytes;
  entries_.push_back({now, robot, std::move(kept)});
  while (bytes_ > most_bytes_ && entries_.size() > 1) drop_oldest();
}

void History::drop_oldest() {
  const Entry& oldest = entries_.front();
  const DecodedLine decoded = decode_telemetry(oldest.text);
  if (decoded.line) before_[oldest.robot].apply(*decoded.line, ++version_);
  bytes_ -= oldest.text.size() + kEntryBytes;
  entries_.pop_front();
}

double History::duration_s() const {
  const std::lock_guard lock(mutex_);
  return entries_.empty() ? 0.0 : (entries_.back().at - entries_.front().at).seconds();
}

std::size_t History::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

Timeline History::timeline() const {
  const std::lock_guard lock(mutex_);
  Timeline timeline;
  MarkFinder marks;
  for (std::size_t i = 0; i < before_.size(); ++i) {
    timeline.robots.push_back(before_[i].name());
    for (TelemetryLine& line : before_[i].as_lines()) {
      marks.note(timeline, 0.0, i, line);
      timeline.before.emplace_back(i, std::move(line));
    }
  }
  for (const Entry& entry : entries_) {
    const DecodedLine decoded = decode_telemetry(entry.text);
    if (!decoded.line) continue;
    if (const auto* hello = decoded.line->as<HelloLine>()) {
      timeline.robots[entry.robot] = hello->robot;
    }
    const double t_s = (entry.at - entries_.front().at).seconds();
    timeline.add(t_s, entry.robot, *decoded.line, entry.text);
    marks.note(timeline, t_s, entry.robot, *decoded.line);
  }
  return timeline;
}

}  // namespace zenith::tools
