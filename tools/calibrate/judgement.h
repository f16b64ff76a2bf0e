#pragma once
// What a calibration is worth, in words for the person who has to decide.

#include <string>
#include <vector>

namespace zenith::tools {

enum class Worth { kGood, kUsable, kAgain };

struct Judgement {
  Worth worth = Worth::kGood;
  std::vector<std::string> reasons;  // what is wrong and what to do, a sentence each

  void lower(Worth to, std::string reason) {
    if (to > worth) worth = to;
    reasons.push_back(std::move(reason));
  }
};

inline const char* worth_text(Worth worth) {
  constexpr const char* kTexts[] = {"good", "usable", "do again"};
  return kTexts[static_cast<int>(worth)];
}

// "verdict: usable" and a line for each reason.
inline std::string judgement_text(const Judgement& judgement) {
  std::string text = std::string("verdict: ") + worth_text(judgement.worth) + "\n";
  for (const std::string& reason : judgement.reasons) text += "  - " + reason + "\n";
  return text;
}

}  // namespace zenith::tools
