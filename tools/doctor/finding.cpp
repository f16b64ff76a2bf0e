#include "tools/doctor/finding.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

namespace zenith::tools {
namespace {

const char* word(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk:
      return "ok";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kSkip:
      return "skip";
  }
  return "?";
}

std::size_t count(const Findings& findings, Verdict verdict) {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(),
                    [verdict](const Finding& finding) { return finding.verdict == verdict; }));
}

}  // namespace

Finding ok(std::string what, std::string found) {
  return {Verdict::kOk, std::move(what), std::move(found), "", ""};
}

Finding warn(std::string what, std::string found, std::string todo, std::string fix) {
  return {Verdict::kWarn, std::move(what), std::move(found), std::move(todo), std::move(fix)};
}

Finding fail(std::string what, std::string found, std::string todo, std::string fix) {
  return {Verdict::kFail, std::move(what), std::move(found), std::move(todo), std::move(fix)};
}

Finding skip(std::string what, std::string why) {
  return {Verdict::kSkip, std::move(what), std::move(why), "", ""};
}

void append(Findings& to, Findings more) {
  for (Finding& finding : more) to.push_back(std::move(finding));
}

std::string finding_line(const Finding& finding, bool hints) {
  char head[64];
  std::snprintf(head, sizeof head, "%-4s  %-18s - ", word(finding.verdict), finding.what.c_str());
  std::string line = head + finding.found;
  if (!finding.todo.empty()) line += "; " + finding.todo;
  std::replace(line.begin(), line.end(), '\n', ' ');
  line += '\n';
  if (!hints || finding.fix.empty()) return line;
  std::size_t begin = 0;
  while (begin < finding.fix.size()) {
    const std::size_t end = std::min(finding.fix.find('\n', begin), finding.fix.size());
    line += "          " + finding.fix.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  return line;
}

std::string findings_summary(const Findings& findings) {
  const std::size_t warnings = count(findings, Verdict::kWarn);
  return std::to_string(findings.size()) +
         " checks: " + std::to_string(count(findings, Verdict::kOk)) + " ok, " +
         std::to_string(warnings) + (warnings == 1 ? " warning, " : " warnings, ") +
         std::to_string(count(findings, Verdict::kFail)) + " failed, " +
         std::to_string(count(findings, Verdict::kSkip)) + " skipped\n";
}

std::string findings_json(const Findings& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& f : findings) {
    std::string verdict = word(f.verdict);
    if (f.verdict == Verdict::kFail) verdict = "fail";
    list.push_back({{"verdict", verdict},
                    {"what", f.what},
                    {"found", f.found},
                    {"todo", f.todo},
                    {"fix", f.fix}});
  }
  const nlohmann::json json = {{"zenith", ZENITH_VERSION},
                               {"findings", list},
                               {"ok", count(findings, Verdict::kOk)},
                               {"warned", count(findings, Verdict::kWarn)},
                               {"failed", count(findings, Verdict::kFail)},
                               {"skipped", count(findings, Verdict::kSkip)}};
  // What a driver calls its card need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

int findings_exit_code(const Findings& findings) {
  return count(findings, Verdict::kFail) > 0 ? 1 : 0;
}

}  // namespace zenith::tools
