#include "tools/view/timeline.h"

#include <cstdio>
#include <fstream>

#include "tools/view/bounded_json.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

constexpr JsonLimits kEntryLimits = {kLongestLine + 256, 7, 65536};
constexpr double kLongest_s = 1e8;  // three years
constexpr std::size_t kMostMarks = 2000;

Error wrong(const std::filesystem::path& file, std::size_t number, const char* what) {
  return Error{file.string() + ":" + std::to_string(number) + ": expected " + what +
               "; `zenith replay --force` writes the file anew"};
}

// Longer lines end at the bound: they are then no JSON.
bool next_line(std::istream& in, std::string& line) {
  line.clear();
  std::streambuf* bytes = in.rdbuf();
  for (int c = bytes->sbumpc(); c != EOF; c = bytes->sbumpc()) {
    if (c == '\n') return true;
    if (line.size() > kEntryLimits.bytes) return true;
    line += static_cast<char>(c);
  }
  return !line.empty();
}

// What was expected instead; null when it is right.
const char* take_first(Timeline& timeline, const json& line) {
  if (read_integer(member(line, "timeline"), 1, 1) != 1) return "timeline version 1";
  const json& names = member(line, "robots");
  const char* expected = "the names of 1 to 64 robots";
  if (!names.is_array() || names.empty() || names.size() > kMostRobots) return expected;
  for (const json& entry : names) {
    auto name = read_text(entry, kLongestName);
    if (!name) return expected;
    timeline.robots.push_back(std::move(*name));
  }
  return nullptr;
}

const char* take_entry(Timeline& timeline, MarkFinder& marks, json line) {
  const auto t_s = read_number(member(line, "t_s"), 0.0, kLongest_s);
  const auto robot = read_integer(member(line, "robot"), 0, kMostRobots);
  if (!t_s || !robot || !line.contains("line")) return "the keys t_s, robot and line";
  if (static_cast<std::size_t>(*robot) >= timeline.robots.size()) return "a robot of line 1";
  if (!timeline.entries.empty() && *t_s < timeline.entries.back().t_s) return "rising times";
  const std::string text = line["line"].dump();
  const DecodedLine decoded = decode_telemetry_json(std::move(line["line"]));
  if (!decoded.line) {
    ++timeline.refused;
    return nullptr;
  }
  timeline.add(*t_s, static_cast<std::size_t>(*robot), *decoded.line, text);
  marks.note(timeline, *t_s, static_cast<std::size_t>(*robot), *decoded.line);
  return nullptr;
}

}  // namespace

void Timeline::add(double t_s, std::size_t robot, const TelemetryLine& line,
                   std::string_view line_text) {
  const auto* picture = line.as<PictureLine>();
  entries.push_back({t_s, static_cast<std::uint32_t>(robot),
                     static_cast<std::uint32_t>(line_text.size()), text.size(),
                     picture != nullptr && picture->jpeg.has_value()});
  text += line_text;
  duration_s = t_s;
}

DecodedLine Timeline::line_of(const Entry& entry) const {
  return decode_telemetry(std::string_view(text).substr(entry.at, entry.bytes));
}

void MarkFinder::note(Timeline& timeline, double t_s, std::size_t robot,
                      const TelemetryLine& line) {
  const auto* alignment = line.as<AlignmentLine>();
  if (alignment == nullptr || timeline.marks.size() >= kMostMarks) return;
  const std::string& name = timeline.robots[robot];
  const std::string& peer = alignment->name;
  const std::string& state = alignment->state;
  std::string& before = states_[name + "/" + peer];
  if (state == "merged" && before != "merged") {
    timeline.marks.push_back({t_s, name + " joins " + peer + "'s map"});
  } else if (state != "merged" && before == "merged") {
    timeline.marks.push_back({t_s, name + " withdraws from " + peer + "'s map"});
  }
  before = state;
}

Result<Timeline> read_timeline(const std::filesystem::path& file) {
  std::error_code unreadable;
  const auto size = std::filesystem::file_size(file, unreadable);
  std::ifstream in;
  if (!unreadable && std::filesystem::is_regular_file(file, unreadable)) in.open(file);
  if (!in.is_open()) {
    return Error{file.string() +
                 ": missing; expected the output folder of `zenith replay` or `zenith demo`"};
  }
  if (size > kMostTimelineBytes) {
    return Error{file.string() + ": expected at most " + std::to_string(kMostTimelineBytes) +
                 " bytes, found " + std::to_string(size) + "; replay a shorter piece"};
  }
  Timeline timeline;
  timeline.text.reserve(size);
  MarkFinder marks;
  std::string text;
  for (std::size_t number = 1; next_line(in, text); ++number) {
    json line = parse_bounded(text, kEntryLimits).value;
    if (!line.is_object()) return wrong(file, number, "a JSON object of at most 1 MB");
    const char* expected =
        number == 1 ? take_first(timeline, line) : take_entry(timeline, marks, std::move(line));
    if (expected != nullptr) return wrong(file, number, expected);
  }
  if (timeline.robots.empty()) return wrong(file, 1, "a line that names the robots");
  return timeline;
}

}  // namespace zenith::tools
