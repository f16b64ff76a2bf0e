#pragma once
// What speaks for a hypothesis of where the robot is in a map: a peer's, a prior one, or its own
// after a loop. One standard for all of them:
//
//   expected and missing   log odds of hits and misses, over the last kWindow searches
//   persistence            so many searches, and a confidence (confidence.h) over them
//   runner-up              no other hypothesis has more than a share of the best one's score
//
//   score = sum hits log(r / w) + misses log((1 - r) / (1 - w))
//
// r, w: how often an expected landmark is found under the right hypothesis, and under a wrong one
// on a ceiling of the same kind.

#include <algorithm>
#include <array>
#include <cmath>

namespace zenith {

// One search's verdict.
struct Support {
  int hits = 0;      // expected landmarks that were found
  int expected = 0;  // landmarks that the hypothesis says must be found
};

struct HitRates {
  double when_right = 0.0;
  double when_wrong = 0.0;
};

inline double log_odds(const Support& s, const HitRates& rates) {
  const double hit = std::log(rates.when_right / rates.when_wrong);
  const double miss = std::log((1.0 - rates.when_right) / (1.0 - rates.when_wrong));
  return hit * s.hits + miss * (s.expected - s.hits);
}

class Evidence {
 public:
  static constexpr int kWindow = 8;  // searches remembered

  void add(const Support& support) {
    window_[static_cast<std::size_t>(searches_ % kWindow)] = support;
    ++searches_;
  }

  int searches() const { return searches_; }
  Support sum() const {
    Support sum;
    for (const Support& s : window_) {
      sum.hits += s.hits;
      sum.expected += s.expected;
    }
    return sum;
  }
  double score(const HitRates& rates) const { return log_odds(sum(), rates); }

 private:
  std::array<Support, kWindow> window_ = {};
  int searches_ = 0;
};

// What a hypothesis must show before it is acted upon.
struct EvidenceStandard {
  double confidence = 0.5;  // Eq. 4
  double score = 80.0;
  double runner_up_share = 0.5;
  int min_searches = 4;
};

// `runner_up_score`: of the best other hypothesis; 0 or less when there is none.
inline bool convinces(double score, int searches, double confidence, double runner_up_score,
                      const EvidenceStandard& standard) {
  return score > standard.score && searches >= standard.min_searches &&
         confidence > standard.confidence &&
         std::max(runner_up_score, 0.0) < standard.runner_up_share * score;
}

}  // namespace zenith
