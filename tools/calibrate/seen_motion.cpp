#include "tools/calibrate/seen_motion.h"

namespace zenith::tools {
namespace {

// As SetupWatch: shorter intervals show little motion, longer ones too much.
constexpr double kShortest_s = 0.14;
constexpr double kOldest_s = 0.7;
constexpr double kMoved = 0.045;  // tangents

}  // namespace

void SeenMotion::add(double time_s, std::span<const Feature> features) {
  const double age_s = time_s - reference_s_;
  if (has_reference_ && age_s < kShortest_s) return;
  if (has_reference_ && age_s <= 2.0 * kOldest_s) {
    const VisualMotion seen = visual_motion(reference_, features);
    if (seen.known && seen.moved < kMoved && age_s < kOldest_s) return;
    if (seen.known) intervals_.push_back({reference_s_, time_s, seen});
  }
  keep_corners(features, reference_);
  reference_s_ = time_s;
  has_reference_ = true;
}

}  // namespace zenith::tools
