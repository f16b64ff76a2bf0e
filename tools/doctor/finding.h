#pragma once
// What one check of `zenith doctor` has to say, and how it is told.

#include <string>
#include <vector>

namespace zenith::tools {

enum class Verdict { kOk, kWarn, kFail, kSkip };

struct Finding {
  Verdict verdict = Verdict::kOk;
  std::string what;   // "camera rate": what was looked at
  std::string found;  // what was found; for kSkip why it was not looked at
  std::string todo;   // what to do about it; empty when all is well
  std::string fix;    // shell commands or lines of a file, for --fix-hints
};

using Findings = std::vector<Finding>;

// For short: what a check returns.
Finding ok(std::string what, std::string found);
Finding warn(std::string what, std::string found, std::string todo, std::string fix = "");
Finding fail(std::string what, std::string found, std::string todo, std::string fix = "");
Finding skip(std::string what, std::string why);

void append(Findings& to, Findings more);

// "FAIL  camera rate    - 7.5 frames a second, 30 wanted; ...", with its end. Line feeds within
// become spaces: one finding, one line. With `hints` the fix follows, indented.
std::string finding_line(const Finding& finding, bool hints);

// "23 checks: 20 ok, 2 warnings, 1 failed, 0 skipped".
std::string findings_summary(const Findings& findings);

// {"findings":[{"verdict":"ok","what":...,"found":...,"todo":...,"fix":...}],"failed":0,...}
std::string findings_json(const Findings& findings);

// 0: no FAIL, 1: one at least.
int findings_exit_code(const Findings& findings);

}  // namespace zenith::tools
