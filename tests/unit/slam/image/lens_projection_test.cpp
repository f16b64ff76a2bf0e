#include "slam/image/lens_projection.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "slam/image/lens_extent.h"
#include "tests/support/figure.h"
#include "tests/support/lenses.h"

namespace zenith {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3d ray_at(double theta, double azimuth) {
  return {std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
          std::cos(theta)};
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A model's formula as its source writes it, in x, y, z; not in angles as slam/image/lens/ has it.
Eigen::Vector2d published(const Lens& l, const Eigen::Vector3d& ray) {
  const double x = ray.x();
  const double y = ray.y();
  const double z = ray.z();
  const double d1 = ray.norm();
  const auto pixel = [&](double mx, double my) {
    return Eigen::Vector2d(l.fu_px * mx + l.cu_px, l.fv_px * my + l.cv_px);
  };
  const auto brown = [&](double a, double b) {
    const double r2 = a * a + b * b;
    const double radial = (1 + l.k[0] * r2 + l.k[1] * r2 * r2 + l.k[2] * r2 * r2 * r2) /
                          (1 + l.k[3] * r2 + l.k[4] * r2 * r2 + l.k[5] * r2 * r2 * r2);
    return pixel(a * radial + 2 * l.p[0] * a * b + l.p[1] * (r2 + 2 * a * a),
                 b * radial + l.p[0] * (r2 + 2 * b * b) + 2 * l.p[1] * a * b);
  };
  switch (l.model) {
    case LensModel::kEquidistant: {
      const double theta = std::acos(z / d1);
      double sum = 1.0;
      for (int i = 0; i < 4; ++i) {
        sum += l.k[static_cast<std::size_t>(i)] * std::pow(theta, 2 * i + 2);
      }
      const double phi = std::atan2(y, x);
      return pixel(theta * sum * std::cos(phi), theta * sum * std::sin(phi));
    }
    case LensModel::kRadtan:
    case LensModel::kRational:
      return brown(x / z, y / z);
    case LensModel::kFov: {
      const double r = std::hypot(x, y);
      // The arc tangent goes on behind the camera's plane.
      double rd = std::atan(2 * std::tan(l.w / 2) * r / z);
      if (rd < 0.0) rd += std::numbers::pi;
      return pixel(rd / l.w * x / r, rd / l.w * y / r);
    }
    case LensModel::kDoubleSphere: {
      const double d2 = std::sqrt(x * x + y * y + (l.xi * d1 + z) * (l.xi * d1 + z));
      const double below = l.alpha * d2 + (1 - l.alpha) * (l.xi * d1 + z);
      return pixel(x / below, y / below);
    }
    case LensModel::kEucm: {
      const double rho = std::sqrt(l.beta * (x * x + y * y) + z * z);
      const double below = l.alpha * rho + (1 - l.alpha) * z;
      return pixel(x / below, y / below);
    }
    case LensModel::kOmni:
      return brown(x / (z + l.xi * d1), y / (z + l.xi * d1));
    case LensModel::kScaramuzza:
      break;
  }
  // OCamCalib's world2cam(): its x runs along rows, its z into the camera.
  const double norm = std::hypot(x, y);
  const double theta = std::atan(-z / norm);
  double rho = 0.0;
  double power = 1.0;
  for (const double b : l.inverse_polynomial) {
    rho += b * power;
    power *= theta;
  }
  const double row = y / norm * rho;
  const double column = x / norm * rho;
  return {row * l.e + column + l.cu_px, row * l.c + column * l.d + l.cv_px};
}

TEST(LensProjection, EachModelIsItsPublishedFormula) {
  double worst_of_all = 0.0;
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    if (lens.model == LensModel::kScaramuzza && lens.polynomial[0] != 0.0) continue;
    const LensProjection projection(lens);
    double worst = 0.0;
    int compared = 0;
    for (double theta = 0.003; theta < projection.limit_rad(); theta += 0.021) {
      for (double azimuth = 0.05; azimuth < 6.28; azimuth += 0.13) {
        const auto pixel = projection.project(2.7 * ray_at(theta, azimuth));
        ASSERT_TRUE(pixel) << name << ' ' << theta;
        if (!projection.in_image(*pixel)) continue;
        worst = std::max(worst, (*pixel - published(lens, 2.7 * ray_at(theta, azimuth))).norm());
        ++compared;
      }
    }
    EXPECT_GT(compared, 300) << name;
    EXPECT_LT(worst, 1e-6) << name;
    worst_of_all = std::max(worst_of_all, worst);
  }
  print_figure("lens models against their published formulas, over the image: %.1e px at worst",
               worst_of_all);
}

// OCamCalib's cam2world(): the polynomial is the ray.
TEST(LensProjection, ASolvedPolynomialIsTheRayThatItSays) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    if (lens.model != LensModel::kScaramuzza || lens.polynomial[0] == 0.0) continue;
    const LensProjection projection(lens);
    for (int v = 3; v < lens.height_px; v += 29) {
      for (int u = 3; u < lens.width_px; u += 31) {
        const double du = u - lens.cu_px;
        const double dv = v - lens.cv_px;
        const double invdet = 1.0 / (lens.c - lens.d * lens.e);
        const double row = invdet * (dv - lens.d * du);
        const double column = invdet * (-lens.e * dv + lens.c * du);
        const double r = std::hypot(row, column);
        double z = 0.0;
        for (std::size_t i = 0; i < lens.polynomial.size(); ++i) {
          z += lens.polynomial[i] * std::pow(r, static_cast<double>(i));
        }
        const Eigen::Vector3d ray(column, row, -z);
        const auto pixel = projection.project(ray);
        ASSERT_TRUE(pixel) << name << ' ' << u << ' ' << v;
        EXPECT_LT((*pixel - Eigen::Vector2d(u, v)).norm(), 1e-6) << name << ' ' << u << ' ' << v;
      }
    }
  }
}

TEST(LensProjection, UnprojectionInvertsProjectionOverTheWholeImage) {
  double worst_of_all = 0.0;
  double widest_of_all = 0.0;
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const LensProjection projection(lens);
    EXPECT_EQ(lens_extent(projection).whole, whole) << name;
    double worst = 0.0;
    int none = 0;
    int all = 0;
    for (int v = 0; v < lens.height_px; v += 11) {
      for (int u = 0; u < lens.width_px; u += 11) {
        const Eigen::Vector2d uv(u, v);
        const auto ray = projection.unproject(uv);
        ++all;
        none += !ray;
        if (!ray) continue;
        ASSERT_NEAR(ray->norm(), 1.0, 1e-12) << name;
        const double theta = std::atan2(ray->head<2>().norm(), ray->z());
        ASSERT_LE(theta, projection.limit_rad()) << name;
        widest_of_all = std::max(widest_of_all, theta);
        const auto back = projection.project(*ray);
        // The inverse polynomial is not quite zero on the axis.
        if (theta < 1e-3 && lens.model == LensModel::kScaramuzza) continue;
        if (theta >= projection.limit_rad() - 1e-6) continue;
        ASSERT_TRUE(back) << name << ' ' << uv.transpose();
        worst = std::max(worst, (*back - uv).norm());
      }
    }
    EXPECT_LT(worst, 1e-6) << name;
    EXPECT_EQ(none > 0, !whole) << name << ' ' << none;
    EXPECT_LT(none, all) << name;
    worst_of_all = std::max(worst_of_all, worst);
  }
  EXPECT_GT(widest_of_all, 100.0 * kDegree);
  print_figure("pixel to ray to pixel, all lens models: %.1e px at worst, rays out to %.0f degrees",
               worst_of_all, widest_of_all / kDegree);
}

TEST(LensProjection, RaysComeBackUpToTheLimit) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const LensProjection projection(lens);
    const double limit = projection.limit_rad();
    ASSERT_GT(limit, 30.0 * kDegree) << name;
    for (const double short_of : {0.5, 0.1, 1e-2, 1e-3, 1e-5, 1e-7}) {
      const double theta = limit - short_of;
      for (double azimuth = 0.0; azimuth < 6.28; azimuth += 0.3) {
        const Eigen::Vector3d ray = ray_at(theta, azimuth);
        const auto pixel = projection.project(ray);
        ASSERT_TRUE(pixel) << name << ' ' << short_of;
        // Far out a tangent's pixels are no pixels any more.
        if (!pixel->allFinite() || pixel->norm() > 1e5) continue;
        const auto back = projection.unproject(*pixel);
        // At a fold the ray is lost in the pixel's last digits.
        if (!back) {
          EXPECT_LT(short_of, 1e-4) << name << ' ' << short_of;
          continue;
        }
        EXPECT_LT(angle_between(*back, ray), 1e-8 + 1e-10 / short_of) << name << ' ' << short_of;
      }
    }
    for (const double beyond : {1e-6, 0.1, 1.0}) {
      EXPECT_FALSE(projection.project(ray_at(std::min(std::numbers::pi, limit + beyond), 0.4)))
          << name;
    }
  }
}

// Up to the limit no two rays share a pixel: the determinant of pixels by angles keeps its sign.
TEST(LensProjection, NothingFoldsWithinTheLimit) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const LensProjection projection(lens);
    constexpr double kStep = 1e-5;
    for (double theta = 0.01; theta < projection.limit_rad() - 2e-4; theta += 0.02) {
      for (double azimuth = 0.0; azimuth < 6.28; azimuth += 0.3) {
        const auto at = [&](double dt, double da) {
          return projection.project(ray_at(theta + dt, azimuth + da)).value();
        };
        const Eigen::Vector2d out = at(kStep, 0.0) - at(-kStep, 0.0);
        const Eigen::Vector2d across = at(0.0, kStep) - at(0.0, -kStep);
        ASSERT_GT(out.x() * across.y() - out.y() * across.x(), 0.0)
            << name << ' ' << theta << ' ' << azimuth;
      }
    }
  }
}

TEST(LensProjection, TheLimitIsWhereTheCurveFolds) {
  Lens lens = lens_of(LensModel::kEquidistant, 640, 480, 150.0);
  lens.k[0] = -2.0;  // 1 - 6 theta^2
  EXPECT_NEAR(LensProjection(lens).limit_rad(), std::sqrt(1.0 / 6.0), 1e-6);
  lens = lens_of(LensModel::kRadtan, 640, 480, 300.0);
  lens.k[0] = -0.3;  // 1 - 0.9 r^2
  EXPECT_NEAR(LensProjection(lens).limit_rad(), std::atan(std::sqrt(1.0 / 0.9)), 1e-6);
  lens.p = {0.03, 0.04};  // 1 - 0.9 r^2 - 0.3 r on the worst side
  const double r = (-0.3 + std::sqrt(0.09 + 3.6)) / 1.8;
  EXPECT_NEAR(LensProjection(lens).limit_rad(), std::atan(r), 1e-6);
  lens = lens_of(LensModel::kOmni, 640, 480, 300.0);
  lens.xi = 2.0;
  EXPECT_NEAR(LensProjection(lens).limit_rad(), std::acos(-0.5), 1e-6);
  lens = lens_of(LensModel::kDoubleSphere, 640, 480, 300.0);
  lens.xi = 0.2;
  lens.alpha = 0.62;
  // On the second sphere the angle's cosine is -w1, where the pinhole's image is widest.
  const double w1 = (1.0 - lens.alpha) / lens.alpha;
  const double c = std::cos(LensProjection(lens).limit_rad());
  EXPECT_NEAR((lens.xi + c) / std::sqrt(1.0 + 2.0 * lens.xi * c + lens.xi * lens.xi), -w1, 1e-6);
}

TEST(LensProjection, TheFocalLengthOnTheAxisIsTheModelsOwn) {
  for (const auto& [name, lens, whole] : lenses_of_all_models()) {
    const LensProjection projection(lens);
    constexpr double kStep = 2e-3;  // wide, for an inverse polynomial is not quite zero on the axis
    const double per_rad = (projection.project(ray_at(2.0 * kStep, 0.0)).value() -
                            projection.project(ray_at(kStep, 0.0)).value())
                               .norm() /
                           kStep;
    EXPECT_NEAR(per_rad / (lens.fu_px * projection.axis_slope()), 1.0, 2e-3) << name;
  }
}

// Numbers that are no lens show nothing or less, and harm nobody.
TEST(LensProjection, WhatIsNoLensShowsNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [name, good, whole] : lenses_of_all_models()) {
    for (const double bad : {nan, inf, -inf, 0.0, 1e300, -1e300, -1.0}) {
      for (int field = 0; field < 12; ++field) {
        Lens lens = good;
        double* const fields[] = {&lens.fu_px, &lens.cv_px, &lens.k[0], &lens.k[1],
                                  &lens.k[4],  &lens.p[0],  &lens.xi,   &lens.alpha,
                                  &lens.beta,  &lens.w,     &lens.c,    &lens.polynomial[0]};
        *fields[field] = bad;
        const LensProjection projection(lens);
        EXPECT_TRUE(projection.limit_rad() >= 0.0 && projection.limit_rad() < 3.2) << name;
        for (const Eigen::Vector2d& uv :
             {Eigen::Vector2d(320.0, 240.0), Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(nan, 3.0),
              Eigen::Vector2d(1e300, -1e300)}) {
          const auto ray = projection.unproject(uv);
          EXPECT_NEAR(ray ? ray->norm() : 1.0, 1.0, 1e-6) << name << field << bad;
        }
        projection.project({0.2, -0.4, 1.0});
        EXPECT_FALSE(projection.project({nan, 0.0, 1.0}));
      }
    }
  }
}

}  // namespace
}  // namespace zenith
