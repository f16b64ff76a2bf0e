#include "slam/image/lens_projection.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "slam/image/lens/double_sphere.h"
#include "slam/image/lens/equidistant.h"
#include "slam/image/lens/eucm.h"
#include "slam/image/lens/fov.h"
#include "slam/image/lens/omni.h"
#include "slam/image/lens/radtan.h"
#include "slam/image/lens/scaramuzza.h"
#include "slam/image/lens/solve.h"

namespace zenith {
namespace {

// A fold narrower than this, which two samples may step over, moves no pixel by a thousandth.
constexpr double kScanStep_rad = 1e-3;
constexpr double kGolden = 0.6180339887498949;
constexpr double kOnAxis = 1e-12;

double domain_rad(const Lens& lens) {
  switch (lens.model) {
    case LensModel::kRadtan:
    case LensModel::kRational:
      return radtan::kDomain_rad;
    case LensModel::kEquidistant:
    case LensModel::kFov:
    case LensModel::kDoubleSphere:
    case LensModel::kEucm:
    case LensModel::kOmni:
    case LensModel::kScaramuzza:
      break;
  }
  return equidistant::kDomain_rad;
}

double rho_of(const Lens& lens, double theta_rad) {
  switch (lens.model) {
    case LensModel::kEquidistant:
      return equidistant::rho(lens, theta_rad);
    case LensModel::kRadtan:
    case LensModel::kRational:
      return radtan::rho(lens, theta_rad);
    case LensModel::kFov:
      return fov::rho(lens, theta_rad);
    case LensModel::kDoubleSphere:
      return double_sphere::rho(lens, theta_rad);
    case LensModel::kEucm:
      return eucm::rho(lens, theta_rad);
    case LensModel::kOmni:
      return omni::rho(lens, theta_rad);
    case LensModel::kScaramuzza:
      return scaramuzza::rho(lens, theta_rad);
  }
  return 0.0;
}

bool is_decentred(const Lens& lens) {
  return (lens.model == LensModel::kRadtan || lens.model == LensModel::kRational ||
          lens.model == LensModel::kOmni) &&
         (lens.p[0] != 0.0 || lens.p[1] != 0.0);
}

// What is distorted: the radius from which decentring counts.
double tangent_of(const Lens& lens, double theta_rad) {
  return lens.model == LensModel::kOmni ? omni::tangent(lens, theta_rad) : std::tan(theta_rad);
}

// What has to rise with theta for no two rays to share a pixel.
double rising_curve(const Lens& lens, double theta_rad) {
  const double rho = rho_of(lens, theta_rad);
  if (!is_decentred(lens)) return rho;
  return rho - radtan::decentring_loss(lens, tangent_of(lens, theta_rad));
}

// The greatest value of the curve between two angles: golden section.
double summit(const Lens& lens, double low, double high) {
  while (high - low > 1e-9) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    // Written so that what is no number lies beyond the summit.
    if (rising_curve(lens, b) > rising_curve(lens, a)) {
      low = a;
    } else {
      high = b;
    }
  }
  return low;
}

struct Limit {
  double theta_rad = 0.0;
  bool folds = false;
};

Limit find_limit(const Lens& lens) {
  const double end = domain_rad(lens);
  double before = rising_curve(lens, 0.0);
  if (!std::isfinite(before)) return {};
  for (int i = 1;; ++i) {
    const double theta = std::min(end, i * kScanStep_rad);
    const double now = rising_curve(lens, theta);
    if (!std::isfinite(now) || now <= before) {
      return {summit(lens, std::max(0.0, theta - 2.0 * kScanStep_rad), theta), true};
    }
    if (theta >= end) return {end, false};
    before = now;
  }
}

double slope_on_axis(const Lens& lens) {
  switch (lens.model) {
    case LensModel::kEquidistant:
    case LensModel::kRadtan:
    case LensModel::kRational:
    case LensModel::kEucm:
      return 1.0;
    case LensModel::kFov:
      return 2.0 * std::tan(0.5 * lens.w) / lens.w;
    case LensModel::kDoubleSphere:
    case LensModel::kOmni:
      return 1.0 / (1.0 + lens.xi);
    case LensModel::kScaramuzza:
      break;
  }
  if (!scaramuzza::has_inverse(lens)) return -lens.polynomial[0];
  constexpr double kStep_rad = 1e-3;
  return (scaramuzza::rho(lens, kStep_rad) - scaramuzza::rho(lens, 0.0)) / kStep_rad;
}

}  // namespace

LensProjection::LensProjection(const Lens& lens)
    : lens_(lens), axis_slope_(slope_on_axis(lens)), decentred_(is_decentred(lens)) {
  const Limit limit = find_limit(lens);
  limit_rad_ = limit.theta_rad;
  folds_ = limit.folds;
  for (std::size_t i = 0; i < kKnots; ++i) {
    knots_[i] = rho(limit_rad_ * static_cast<double>(i) / (kKnots - 1));
  }
}

double LensProjection::rho(double theta_rad) const {
  return rho_of(lens_, theta_rad);
}

double LensProjection::tangent(double theta_rad) const {
  return tangent_of(lens_, theta_rad);
}

std::optional<Eigen::Vector2d> LensProjection::project(const Eigen::Vector3d& ray) const {
  const double r = std::hypot(ray.x(), ray.y());
  const double theta = std::atan2(r, ray.z());
  if (!(theta < limit_rad_)) return std::nullopt;
  if (r < kOnAxis) return Eigen::Vector2d(lens_.cu_px, lens_.cv_px);
  const double scale = rho(theta) / r;
  if (!decentred_ && lens_.model != LensModel::kScaramuzza) {
    return Eigen::Vector2d(lens_.fu_px * scale * ray.x() + lens_.cu_px,
                           lens_.fv_px * scale * ray.y() + lens_.cv_px);
  }
  Eigen::Vector2d m = scale * ray.head<2>();
  if (decentred_) {
    m += radtan::decentring(lens_, tangent(theta) / r * ray.head<2>());
  } else {
    m = scaramuzza::shear(lens_, m);
  }
  return Eigen::Vector2d(lens_.fu_px * m.x() + lens_.cu_px, lens_.fv_px * m.y() + lens_.cv_px);
}

// Of a radius below the last knot.
double LensProjection::theta_of_rho(double rho_wanted) const {
  const auto above = std::upper_bound(knots_.begin(), knots_.end(), rho_wanted);
  if (above == knots_.begin()) return 0.0;
  const auto i = static_cast<double>(above - knots_.begin());
  const double step = limit_rad_ / (kKnots - 1);
  return solve_between([&](double theta) { return rho(theta) - rho_wanted; }, (i - 1.0) * step,
                       i * step);
}

// The point without decentring that is seen at m: Newton's method, the derivative by differences.
std::optional<Eigen::Vector2d> LensProjection::without_decentring(const Eigen::Vector2d& m) const {
  const auto seen = [this](const Eigen::Vector2d& x) {
    const double r = x.norm();
    if (r < kOnAxis) return x;
    return Eigen::Vector2d(radtan::distort(lens_, r) / r * x + radtan::decentring(lens_, x));
  };
  const double farthest = tangent(limit_rad_);
  const double last = knots_.back();
  const double rho_m = std::min(m.norm(), 0.999 * last);
  Eigen::Vector2d x = m.norm() < kOnAxis ? Eigen::Vector2d::Zero().eval()
                                         : (m / m.norm() * tangent(theta_of_rho(rho_m))).eval();
  Eigen::Vector2d off = seen(x) - m;
  for (int i = 0; i < 40 && off.norm() > 1e-15 * (1.0 + m.norm()); ++i) {
    const double h = 1e-6 * (1.0 + x.norm());
    Eigen::Matrix2d J;
    J.col(0) = (seen(x + Eigen::Vector2d(h, 0.0)) - seen(x - Eigen::Vector2d(h, 0.0))) / (2.0 * h);
    J.col(1) = (seen(x + Eigen::Vector2d(0.0, h)) - seen(x - Eigen::Vector2d(0.0, h))) / (2.0 * h);
    const Eigen::Vector2d step = J.inverse() * off;
    // Half steps while the whole one leads away.
    bool better = false;
    for (double share = 1.0; share > 1e-3 && !better; share *= 0.5) {
      const Eigen::Vector2d tried = x - share * step;
      if (!(tried.norm() <= farthest)) continue;
      const Eigen::Vector2d now = seen(tried) - m;
      if (!(now.norm() < off.norm())) continue;
      x = tried;
      off = now;
      better = true;
    }
    if (!better) break;
  }
  if (!(off.norm() < 1e-11 * (1.0 + m.norm())) || !(x.norm() < farthest)) return std::nullopt;
  return x;
}

std::optional<Eigen::Vector3d> LensProjection::unproject(const Eigen::Vector2d& uv) const {
  Eigen::Vector2d m((uv.x() - lens_.cu_px) / lens_.fu_px, (uv.y() - lens_.cv_px) / lens_.fv_px);
  if (lens_.model == LensModel::kScaramuzza) m = scaramuzza::unshear(lens_, m);
  if (!m.allFinite()) return std::nullopt;
  if (decentred_) {
    const auto x = without_decentring(m);
    if (!x) return std::nullopt;
    const double r = x->norm();
    if (lens_.model != LensModel::kOmni) return Eigen::Vector3d(x->x(), x->y(), 1.0).normalized();
    // The sphere's point: Mei's lifting.
    const double s =
        (lens_.xi + std::sqrt(1.0 + (1.0 - lens_.xi * lens_.xi) * r * r)) / (1.0 + r * r);
    return Eigen::Vector3d(s * x->x(), s * x->y(), s - lens_.xi);
  }
  const double radius = m.norm();
  if (!(radius < knots_.back())) return std::nullopt;
  if (radius < kOnAxis) return Eigen::Vector3d(0.0, 0.0, 1.0);
  const double theta = theta_of_rho(radius);
  const double s = std::sin(theta) / radius;
  return Eigen::Vector3d(m.x() * s, m.y() * s, std::cos(theta));
}

}  // namespace zenith
