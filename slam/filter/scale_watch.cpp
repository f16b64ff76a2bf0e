#include "slam/filter/scale_watch.h"

#include <algorithm>
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
  const double error2 = std::max(vv_ - factor * vw_, 0.0) / ((kPieces - 1) * ww_);
  const double off = std::abs(factor - 1.0);
  const bool wrong = off > kWrong && off > kSigmas * std::sqrt(error2) && factor > kLeast;
  reset();
  return wrong;
}

}  // namespace zenith
