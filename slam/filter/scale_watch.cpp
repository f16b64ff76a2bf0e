#include "slam/filter/scale_watch.h"

#include <cmath>

namespace zenith {

bool ScaleWatch::note(double wheels_m, double seen_m) {
  piece_wheels_m_ += wheels_m;
  piece_seen_m_ += seen_m;
  if (std::abs(piece_wheels_m_) < kPiece_m) return false;
  ww_ += piece_wheels_m_ * piece_wheels_m_;
  vw_ += piece_seen_m_ * piece_wheels_m_;
  vv_ += piece_seen_m_ * piece_seen_m_;
  piece_wheels_m_ = piece_seen_m_ = 0.0;
  if (++pieces_ < kPieces) return false;
  const double factor = vw_ / ww_;
  const double unexplained = vv_ - factor * vw_;
  const bool wrong =
      std::abs(factor - 1.0) > kWrong && factor > kLeast && unexplained < kUnexplained * vv_;
  reset();
  return wrong;
}

}  // namespace zenith
