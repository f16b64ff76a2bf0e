#include "slam/recovery/relocaliser.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace zenith {
namespace {

constexpr double kSearchDistance_m = 0.15;
constexpr double kSearchTurn_rad = 0.15;
// As of prior maps.
constexpr EvidenceStandard kPriorMaps = {0.5, 12.0, 0.5, 4};
constexpr double kLeastTravel_m = 0.45;
// Of evidence_at(), on simulated ceilings: 0.6 to 0.8 at the right pose, 0.1 to 0.3 at wrong ones.
constexpr HitRates kRates = {0.6, 0.3};
constexpr int kLeastHits = 8;  // of a pose that is worth a test

}  // namespace

double Relocaliser::Guess::score() const {
  return evidence.score(kRates);
}

void Relocaliser::Guess::test(const FrameOverMap& frame) {
  const PoseEvidence found = evidence_at(frame, T_own_robot);
  T_own_robot = found.T_own_robot;
  evidence.add({found.hits, found.expected});
}

bool Relocaliser::search_due(const Pose2& moved) {
  const double travel_m = moved.position().norm();
  travel_m_ += travel_m;
  turn_rad_ += std::abs(moved.theta_rad);
  for (Guess& g : guesses_) {
    g.T_own_robot = g.T_own_robot * moved;
    g.travel_m += travel_m;
  }
  if (std::exchange(begun_, true) && travel_m_ < kSearchDistance_m && turn_rad_ < kSearchTurn_rad) {
    return false;
  }
  travel_m_ = 0.0;
  turn_rad_ = 0.0;
  return true;
}

void Relocaliser::propose(const FrameOverMap& frame, PoseSearch& search) {
  PoseSearch::Poses poses;
  search.find(frame, {}, poses);
  for (const PoseEvidence& found : poses) {
    if (found.hits < kLeastHits) continue;
    const bool known = std::any_of(guesses_.begin(), guesses_.end(), [&](const Guess& g) {
      return same_alignment(g.T_own_robot, found.T_own_robot, g.T_own_robot.position());
    });
    if (known) continue;
    Guess guess;
    guess.T_own_robot = found.T_own_robot;
    guess.evidence.add({found.hits, found.expected});
    if (guesses_.push_back(guess)) continue;
    auto* worst =
        std::min_element(guesses_.begin(), guesses_.end(),
                         [](const auto& a, const auto& b) { return a.score() < b.score(); });
    if (worst->score() < guess.score()) *worst = guess;
  }
}

void Relocaliser::drop_twins() {
  for (std::size_t i = 0; i < guesses_.size(); ++i) {
    for (std::size_t k = i + 1; k < guesses_.size();) {
      const Pose2& a = guesses_[i].T_own_robot;
      if (!same_alignment(a, guesses_[k].T_own_robot, a.position())) {
        ++k;
        continue;
      }
      if (guesses_[i].score() < guesses_[k].score()) std::swap(guesses_[i], guesses_[k]);
      guesses_.swap_remove(k);
    }
  }
}

std::optional<Pose2> Relocaliser::decide() const {
  const Guess* best = nullptr;
  for (const Guess& g : guesses_) {
    if (best == nullptr || g.score() > best->score()) best = &g;
  }
  if (best == nullptr || best->travel_m < kLeastTravel_m) return std::nullopt;
  double runner_up = 0.0;
  for (const Guess& g : guesses_) {
    if (&g != best) runner_up = std::max(runner_up, g.score());
  }
  // Its persistence is that of the searches: the wheels carry it from one to the next.
  constexpr double kConfident = 1.0;
  if (!convinces(best->score(), best->evidence.searches(), kConfident, runner_up, kPriorMaps)) {
    return std::nullopt;
  }
  return best->T_own_robot;
}

std::optional<Pose2> Relocaliser::step(const FrameOverMap& frame, const Pose2& moved,
                                       PoseSearch& search) {
  if (!search_due(moved)) return std::nullopt;
  for (Guess& g : guesses_) g.test(frame);
  drop_twins();
  propose(frame, search);
  return decide();
}

}  // namespace zenith
