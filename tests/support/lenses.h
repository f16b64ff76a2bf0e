#pragma once
// Lenses of every model: of cameras that exist, and at the edges of what the models can.

#include <string>
#include <vector>

#include "slam/image/lens.h"

namespace zenith {

struct NamedLens {
  std::string name;
  Lens lens;
  bool whole = true;  // every pixel of the image has a ray
};

inline Lens lens_of(LensModel model, int width_px, int height_px, double f_px) {
  Lens lens;
  lens.model = model;
  lens.width_px = width_px;
  lens.height_px = height_px;
  lens.fu_px = f_px;
  lens.fv_px = 1.003 * f_px;
  lens.cu_px = 0.503 * width_px;
  lens.cv_px = 0.489 * height_px;
  return lens;
}

inline std::vector<NamedLens> lenses_of_all_models() {
  std::vector<NamedLens> all;
  const auto add = [&all](const char* name, const Lens& lens, bool whole = true) {
    all.push_back({name, lens, whole});
  };

  Lens l = lens_of(LensModel::kEquidistant, 640, 480, 150.0);
  l.k = {-0.012, 0.004, -0.0015, 0.0001};
  add("equidistant, the simulator's", l, false);
  l = lens_of(LensModel::kEquidistant, 848, 800, 286.9);
  l.k = {-0.0075, 0.0418, -0.0394, 0.0069};
  add("equidistant, a tracking camera's", l);
  l = lens_of(LensModel::kEquidistant, 640, 640, 105.0);
  l.k = {0.02, -0.004, 0.001, 0.0};
  add("equidistant, 200 degrees in the image", l);
  l = lens_of(LensModel::kEquidistant, 640, 480, 150.0);
  l.k = {-0.1, -0.02, 0.0, 0.0};
  add("equidistant that folds in the image", l, false);

  l = lens_of(LensModel::kRadtan, 752, 480, 458.654);
  l.k = {-0.28340811, 0.07395907};
  l.p = {0.00019359, 1.76187114e-05};
  add("radtan, EuRoC's", l);
  l = lens_of(LensModel::kRadtan, 640, 480, 500.0);
  add("radtan without distortion", l);
  l = lens_of(LensModel::kRadtan, 1280, 720, 1400.0);
  l.k = {0.05, -0.4, 1.9};
  l.p = {-0.002, 0.001};
  add("radtan, a narrow one with k3", l);
  l = lens_of(LensModel::kRadtan, 640, 480, 300.0);
  l.k = {-0.2, 0.03, 0.0};
  l.p = {0.02, -0.015};
  add("radtan, badly decentred", l);
  l = lens_of(LensModel::kRadtan, 640, 480, 260.0);
  l.k = {-0.3, 0.0, 0.0};
  add("radtan that folds in the image", l, false);

  l = lens_of(LensModel::kRational, 1280, 720, 608.0);
  l.k = {0.4469, -2.4716, 1.4303, 0.3232, -2.2977, 1.3636};
  l.p = {0.000866, -0.000246};
  add("rational, a depth camera's", l);
  l = lens_of(LensModel::kRational, 1280, 960, 480.0);
  l.k = {2.1, 0.35, 0.002, 2.43, 0.78, 0.03};
  l.p = {0.0002, 0.0001};
  add("rational that folds in the image", l, false);

  l = lens_of(LensModel::kFov, 640, 480, 250.0);
  l.w = 0.93;
  add("fov", l);
  l = lens_of(LensModel::kFov, 640, 640, 180.0);
  l.w = 1.6;
  add("fov, beyond 90 degrees", l, false);

  l = lens_of(LensModel::kDoubleSphere, 512, 512, 158.28);
  l.xi = -0.2973;
  l.alpha = 0.5708;
  add("double_sphere, TUM-VI's", l);
  l = lens_of(LensModel::kDoubleSphere, 800, 800, 250.0);
  l.xi = 0.2;
  l.alpha = 0.62;
  add("double_sphere, its image circle in the image", l, false);
  l = lens_of(LensModel::kDoubleSphere, 640, 480, 300.0);
  l.xi = 0.0;
  l.alpha = 0.3;
  add("double_sphere, near a pinhole", l);

  l = lens_of(LensModel::kEucm, 512, 512, 190.9);
  l.alpha = 0.6283550447635853;
  l.beta = 1.0458678747533083;
  add("eucm, TUM-VI's", l);
  l = lens_of(LensModel::kEucm, 640, 480, 110.0);
  l.alpha = 0.75;
  l.beta = 0.9;
  add("eucm, its image circle in the image", l, false);

  l = lens_of(LensModel::kOmni, 1280, 1024, 1050.0);
  l.xi = 0.94;
  l.k = {-0.21, 0.15};
  l.p = {0.0003, -0.0011};
  add("omni, a fisheye's", l);
  l = lens_of(LensModel::kOmni, 752, 480, 600.0);
  l.xi = 1.9;
  add("omni without distortion", l, false);
  l = lens_of(LensModel::kOmni, 1000, 1000, 900.0);
  l.xi = 1.6;
  l.k = {0.1, -0.02};
  l.p = {0.004, 0.003};
  add("omni beyond 90 degrees, decentred", l);

  l = lens_of(LensModel::kScaramuzza, 752, 480, 1.0);
  l.fv_px = 1.0;
  l.c = 1.0002;
  l.d = 0.0007;
  l.e = -0.0011;
  l.polynomial = {-209.2, 0.0, 8.1e-4, 6.3e-7, 1.5e-9};
  add("scaramuzza, solved", l);
  l.polynomial = {-110.0, 0.0, 1.5e-3, -1.1e-6, 9e-9, 0.0, 3e-15};
  add("scaramuzza, beyond 90 degrees, sixth degree", l);
  // Of rho = 209.2 (t - 0.04 t^3), t = theta: about the first of these two.
  l.polynomial = {};
  const double f = 209.2;
  const double h = 1.5707963267948966;
  l.inverse_polynomial = {f * (h - 0.04 * h * h * h), f * (1.0 - 0.12 * h * h), -f * 0.12 * h,
                          -f * 0.04};
  add("scaramuzza, inverse polynomial", l, false);
  return all;
}

}  // namespace zenith
