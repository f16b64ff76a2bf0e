#include "slam/filter/landmark_stacked.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace zenith {
namespace {

constexpr double kFloor = 1e-9;  // variances stay above it, as in update_landmark()

struct State {
  Eigen::Vector3d x;
  Eigen::Matrix3d P;
};

State load(const LandmarkRows& l, int i) {
  State s;
  s.x << l.ax[i], l.ay[i], l.rho[i];
  s.P << l.pxx[i], l.pxy[i], l.pxr[i], l.pxy[i], l.pyy[i], l.pyr[i], l.pxr[i], l.pyr[i], l.prr[i];
  return s;
}

void store(const State& s, const LandmarkRows& l, int i) {
  l.ax[i] = static_cast<float>(s.x[0]);
  l.ay[i] = static_cast<float>(s.x[1]);
  l.rho[i] = static_cast<float>(s.x[2]);
  l.pxx[i] = static_cast<float>(std::max(s.P(0, 0), kFloor));
  l.pxy[i] = static_cast<float>(s.P(0, 1));
  l.pxr[i] = static_cast<float>(s.P(0, 2));
  l.pyy[i] = static_cast<float>(std::max(s.P(1, 1), kFloor));
  l.pyr[i] = static_cast<float>(s.P(1, 2));
  l.prr[i] = static_cast<float>(std::max(s.P(2, 2), kFloor));
}

Eigen::Matrix<double, 2, 3> jacobian(const LandmarkRows& l, const CameraRows& camera, int i) {
  const double ca = l.anchor_cos[i];
  const double sa = l.anchor_sin[i];
  const double ct = camera.cos[i];
  const double st = camera.sin[i];
  const double c = ca * ct + sa * st;
  const double s = sa * ct - ca * st;
  const double dx = static_cast<double>(l.anchor_x[i]) - static_cast<double>(camera.x[i]);
  const double dy = static_cast<double>(l.anchor_y[i]) - static_cast<double>(camera.y[i]);
  Eigen::Matrix<double, 2, 3> H;
  H << c, -s, ct * dx + st * dy, s, c, ct * dy - st * dx;
  return H;
}

// 2 log N(e; 0, S), without the constant that cancels.
template <int k>
double shared_log_likelihood(const Eigen::Matrix<double, 2 * k, 1>& e,
                             const Eigen::Matrix<double, 2 * k, 2 * k>& S,
                             const Eigen::LLT<Eigen::Matrix<double, 2 * k, 2 * k>>& llt) {
  double together = -e.dot(llt.solve(e));
  for (int r = 0; r < 2 * k; ++r) together -= 2.0 * std::log(llt.matrixLLT()(r, r));
  double apart = 0.0;
  for (int j = 0; j < k; ++j) {
    const Eigen::Matrix2d own = S.template block<2, 2>(2 * j, 2 * j);
    const Eigen::Vector2d d = e.template segment<2>(2 * j);
    apart -= d.dot(own.inverse() * d) + std::log(own.determinant());
  }
  return together - apart;
}

template <int k>
void update(const LandmarkRows& l, const StackedObservation* observers, int particles,
            double* log_weight) {
  using Residual = Eigen::Matrix<double, 2 * k, 1>;
  using Jacobian = Eigen::Matrix<double, 2 * k, 3>;
  using Innovation = Eigen::Matrix<double, 2 * k, 2 * k>;
  Residual variances;
  for (int j = 0; j < k; ++j) variances.template segment<2>(2 * j).setConstant(observers[j].noise);
  for (int i = 0; i < particles; ++i) {
    State s = load(l, i);
    Jacobian H;
    Residual z;
    for (int j = 0; j < k; ++j) {
      H.template middleRows<2>(2 * j) = jacobian(l, observers[j].camera, i);
      z[2 * j] = observers[j].zx;
      z[2 * j + 1] = observers[j].zy;
    }
    const Residual e = z - H * s.x;
    const Jacobian HP = H * s.P;
    Innovation S = HP * H.transpose();
    S.diagonal() += variances;
    const Eigen::LLT<Innovation> llt(S);
    const Jacobian K = llt.solve(HP);  // transposed
    s.x += K.transpose() * e;
    s.P -= K.transpose() * HP;
    store(s, l, i);
    if (log_weight != nullptr) log_weight[i] += 0.5 * shared_log_likelihood<k>(e, S, llt);
  }
}

using Update = void (*)(const LandmarkRows&, const StackedObservation*, int, double*);

template <int... k>
constexpr std::array<Update, sizeof...(k)> updates(std::integer_sequence<int, k...>) {
  return {&update<k + 1>...};
}

constexpr auto kUpdates = updates(std::make_integer_sequence<int, kMaxObservers>());

}  // namespace

void update_landmark_stacked(const LandmarkRows& landmark,
                             std::span<const StackedObservation> observers, int particles,
                             double* log_weight) {
  assert(!observers.empty() && observers.size() <= kUpdates.size());
  if (observers.empty() || observers.size() > kUpdates.size()) return;
  kUpdates[observers.size() - 1](landmark, observers.data(), particles, log_weight);
}

}  // namespace zenith
