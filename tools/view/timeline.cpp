#include "tools/view/timeline.h"

#include <fstream>
#include <map>

namespace zenith::tools {
namespace {

using nlohmann::json;

Error wrong(const std::filesystem::path& file, std::size_t number, const char* what) {
  return Error{file.string() + ":" + std::to_string(number) + ": expected " + what +
               "; `zenith replay --force` writes the file anew"};
}

void note_mark(Timeline& timeline, const Timeline::Entry& entry,
               std::map<std::string, std::string>& states) {
  if (entry.line.value("type", "") != "alignment") return;
  const std::string& robot = timeline.robots[entry.robot];
  const std::string peer = entry.line.value("name", "?");
  const std::string state = entry.line.value("state", "");
  std::string& before = states[robot + "/" + peer];
  if (state == "merged" && before != "merged") {
    timeline.marks.push_back({entry.t_s, robot + " joins " + peer + "'s map"});
  } else if (state != "merged" && before == "merged") {
    timeline.marks.push_back({entry.t_s, robot + " withdraws from " + peer + "'s map"});
  }
  before = state;
}

}  // namespace

void find_marks(Timeline& timeline) {
  timeline.marks.clear();
  std::map<std::string, std::string> states;
  for (const Timeline::Entry& entry : timeline.entries) note_mark(timeline, entry, states);
}

Result<Timeline> read_timeline(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) {
    return Error{file.string() +
                 ": missing; expected the output folder of `zenith replay` or `zenith demo`"};
  }
  Timeline timeline;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    json line = json::parse(text, nullptr, false);
    if (!line.is_object()) return wrong(file, number, "a JSON object");
    try {
      if (number == 1) {
        if (line.at("timeline").get<int>() != 1) return wrong(file, 1, "timeline version 1");
        timeline.robots = line.at("robots").get<std::vector<std::string>>();
        continue;
      }
      Timeline::Entry entry = {line.at("t_s").get<double>(), line.at("robot").get<std::size_t>(),
                               std::move(line.at("line"))};
      if (entry.robot >= timeline.robots.size()) return wrong(file, number, "a robot of line 1");
      if (!timeline.entries.empty() && entry.t_s < timeline.entries.back().t_s) {
        return wrong(file, number, "rising times");
      }
      timeline.entries.push_back(std::move(entry));
    } catch (const json::exception&) {
      return wrong(file, number, "the keys t_s, robot and line");
    }
  }
  if (timeline.robots.empty()) return wrong(file, 1, "a line that names the robots");
  if (!timeline.entries.empty()) timeline.duration_s = timeline.entries.back().t_s;
  find_marks(timeline);
  return timeline;
}

}  // namespace zenith::tools
