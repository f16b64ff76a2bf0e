#include "tools/view/history.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr Duration kPictureEvery = {1'000'000'000};
constexpr std::size_t kEntryBytes = 96;  // besides its text

}  // namespace

void History::add(const std::string& label) {
  const std::lock_guard lock(mutex_);
  before_.emplace_back(label);
  kept_.emplace_back(kPictureEvery);
}

void History::note(std::size_t robot, const RobotState& state, const json& line,
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
  before_[oldest.robot].apply(json::parse(oldest.text, nullptr, false), ++version_);
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
  for (std::size_t i = 0; i < before_.size(); ++i) {
    timeline.robots.push_back(before_[i].name());
    for (json& line : before_[i].as_lines()) timeline.entries.push_back({0.0, i, std::move(line)});
  }
  for (const Entry& entry : entries_) {
    json line = json::parse(entry.text, nullptr, false);
    if (line.value("type", "") == "hello") timeline.robots[entry.robot] = line.value("robot", "?");
    timeline.entries.push_back(
        {(entry.at - entries_.front().at).seconds(), entry.robot, std::move(line)});
  }
  if (!timeline.entries.empty()) timeline.duration_s = timeline.entries.back().t_s;
  find_marks(timeline);
  return timeline;
}

}  // namespace zenith::tools
