#pragma once
// What is known of a lens: which model describes it, and the model's numbers. Plain data; pixels
// and rays come from LensProjection (slam/image/lens_projection.h).
//
// Camera frame: z out of the lens, x along u (columns), y along v (rows); the first pixel's centre
// is (0, 0). All models are radial curves, rho of the angle theta between the ray and the optical
// axis, with what some add to it (a decentring, a sheared sensor):
//
//   e = (X, Y) / |(X, Y)|, theta = atan2(|(X, Y)|, Z)
//   m = rho(theta) e + decentring,   u = fu m_x + cu,   v = fv m_y + cv
//
// | model         | numbers                  | rho in          | source of the formula            |
// |---------------|--------------------------|-----------------|----------------------------------|
// | equidistant   | k1 k2 k3 k4              | equidistant.h   | Kannala, Brandt, PAMI 2006       |
// | radtan        | k1 k2 p1 p2 k3           | radtan.h        | Brown 1966; OpenCV; all zero:    |
// |               |                          |                 | a pinhole                        |
// | rational      | k1 k2 p1 p2 k3 k4 k5 k6  | radtan.h        | OpenCV                           |
// | fov           | w                        | fov.h           | Devernay, Faugeras, MVA 2001     |
// | double_sphere | xi alpha                 | double_sphere.h | Usenko et al., 3DV 2018          |
// | eucm          | alpha beta               | eucm.h          | Khomutenko et al., RA-L 2016     |
// | omni          | xi k1 k2 p1 p2           | omni.h          | Mei, Rives, ICRA 2007            |
// | scaramuzza    | c d e, polynomial,       | scaramuzza.h    | Scaramuzza et al., ICVS 2006;    |
// |               | inverse_polynomial       |                 | OCamCalib                        |
//
// docs/calibration.md has the names that other programs give them.

#include <array>
#include <cstdint>

namespace zenith {

enum class LensModel : std::uint8_t {
  kEquidistant,
  kRadtan,
  kRational,
  kFov,
  kDoubleSphere,
  kEucm,
  kOmni,
  kScaramuzza,
};
inline constexpr int kLensModels = 8;

struct Lens {
  int width_px = 640;
  int height_px = 480;
  double fu_px = 150.0;  // scaramuzza: 1, its polynomial is in pixels
  double fv_px = 150.0;
  double cu_px = 320.0;
  double cv_px = 240.0;
  std::array<double, 6> k = {};  // radial
  LensModel model = LensModel::kEquidistant;
  std::array<double, 2> p = {};  // decentring
  double xi = 0.0;
  double alpha = 0.0;
  double beta = 1.0;
  double w = 0.0;  // rad
  // Scaramuzza's: (v, u) = [c d; e 1] (rho e_y, rho e_x) + (cv, cu); a0 a1 .. below zero on the
  // axis, as OCamCalib writes them; zeros behind the last. An inverse polynomial that is not given
  // is all zeros.
  double c = 1.0;
  double d = 0.0;
  double e = 0.0;
  std::array<double, 12> polynomial = {};
  std::array<double, 32> inverse_polynomial = {};

  bool operator==(const Lens&) const = default;
};

}  // namespace zenith
