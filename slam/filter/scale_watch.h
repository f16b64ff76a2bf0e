#pragma once
// Whether the wheels and the map's landmarks tell the same distances. All depths of a map come from
// its first baselines: when one of them was wrong, for a frame carried another frame's stamp or the
// wheels were missing, the map is too small or too large by one factor, agrees with itself, and
// makes the wheels look as if they slipped for ever. Wheels that do slip do so by changing factors.
//
//   v_i = r w_i + e_i over n pieces of 5 cm:   r = sum v w / sum w^2,
//   sigma_r^2 = sum e^2 / ((n - 1) sum w^2),   sum e^2 = sum v^2 - r sum v w

namespace zenith {

class ScaleWatch {
 public:
  // Forward motion of one frame in metres, by the wheels and by the landmarks. True: over the last
  // half metre they differed by one factor. Only of straight driving: in curves an imperfect mount
  // tells other distances.
  bool note(double wheels_m, double seen_m);
  void reset() { *this = {}; }

 private:
  static constexpr double kPiece_m = 0.05;
  static constexpr int kPieces = 10;
  static constexpr double kWrong = 0.04;  // of the factor, away from 1
  static constexpr double kSigmas = 5.0;  // likewise
  static constexpr double kLeast = 0.2;   // below it a robot stands and its wheels spin

  double piece_wheels_m_ = 0.0;
  double piece_seen_m_ = 0.0;
  double ww_ = 0.0;
  double vw_ = 0.0;
  double vv_ = 0.0;
  int pieces_ = 0;
};

}  // namespace zenith
