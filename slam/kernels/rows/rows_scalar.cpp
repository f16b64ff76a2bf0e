// The specification of the row kernels. Equations: slam/filter/landmark.h, slam/filter/proposal.h.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "slam/kernels/rows/rows.h"

namespace zenith {

float row_log(float given) {
  const float x = std::max(given, std::numeric_limits<float>::min());
  // x = m 2^e with m in [1/2, 1), then in [sqrt(1/2), sqrt(2)).
  const auto bits = std::bit_cast<std::int32_t>(x);
  std::int32_t e = (bits >> 23) - 126;
  auto m = std::bit_cast<float>((bits & 0x007fffff) | 0x3f000000);
  if (m < 0.707106781186547524F) {
    e -= 1;
    m = m + m;
  }
  const float z = m - 1.0F;
  const float z2 = z * z;
  float p = z * 7.0376836292e-2F - 1.1514610310e-1F;
  p = p * z + 1.1676998740e-1F;
  p = p * z - 1.2420140846e-1F;
  p = p * z + 1.4249322787e-1F;
  p = p * z - 1.6668057665e-1F;
  p = p * z + 2.0000714765e-1F;
  p = p * z - 2.4999993993e-1F;
  p = p * z + 3.3333331174e-1F;
  const auto fe = static_cast<float>(e);
  float y = z * z2 * p;
  y = y + fe * -2.12194440e-4F;  // with 0.693359375: ln 2 in two parts
  y = y - z2 * 0.5F;
  return z + y + fe * 0.693359375F;
}

namespace {

// What the observation of one particle needs: R(theta_a - theta_t) as (c, s), b, and m.
struct View {
  float c, s, bx, by, mx, my;
};

View view(const LandmarkRows& l, const CameraRows& camera, int i) {
  const float ct = camera.cos[i];
  const float st = camera.sin[i];
  const float c = l.anchor_cos[i] * ct + l.anchor_sin[i] * st;
  const float s = l.anchor_sin[i] * ct - l.anchor_cos[i] * st;
  const float dx = l.anchor_x[i] - camera.x[i];
  const float dy = l.anchor_y[i] - camera.y[i];
  const float bx = ct * dx + st * dy;
  const float by = ct * dy - st * dx;
  return {c,
          s,
          bx,
          by,
          c * l.ax[i] - s * l.ay[i] + l.rho[i] * bx,
          s * l.ax[i] + c * l.ay[i] + l.rho[i] * by};
}

// P H^T, a 3 x 2 matrix; H's rows are (c, -s, bx) and (s, c, by).
struct Gain {
  float x0, x1, y0, y1, r0, r1;
};

Gain covariance_times_h(const LandmarkRows& l, const View& v, int i) {
  return {l.pxx[i] * v.c - l.pxy[i] * v.s + l.pxr[i] * v.bx,
          l.pxx[i] * v.s + l.pxy[i] * v.c + l.pxr[i] * v.by,
          l.pxy[i] * v.c - l.pyy[i] * v.s + l.pyr[i] * v.bx,
          l.pxy[i] * v.s + l.pyy[i] * v.c + l.pyr[i] * v.by,
          l.pxr[i] * v.c - l.pyr[i] * v.s + l.prr[i] * v.bx,
          l.pxr[i] * v.s + l.pyr[i] * v.c + l.prr[i] * v.by};
}

struct Symmetric2 {
  float xx, xy, yy;
};

Symmetric2 innovation(const Gain& g, const View& v) {
  return {v.c * g.x0 - v.s * g.y0 + v.bx * g.r0, v.c * g.x1 - v.s * g.y1 + v.bx * g.r1,
          v.s * g.x1 + v.c * g.y1 + v.by * g.r1};
}

Symmetric2 with_noise(const Symmetric2& s, const Sight& sight) {
  return {s.xx + sight.noise, s.xy, s.yy + sight.noise};
}

Symmetric2 with_shared(const Symmetric2& s, const Gain& g, const Sight& sight) {
  const float ux = sight.shared * g.r0;
  const float uy = sight.shared * g.r1;
  return {s.xx + ux * ux, s.xy + ux * uy, s.yy + uy * uy};
}

void predict(const LandmarkRows& l, const CameraRows& camera, int particles,
             const PredictionRows& out) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Symmetric2 s = innovation(covariance_times_h(l, v, i), v);
    out.mx[i] = v.mx;
    out.my[i] = v.my;
    out.sxx[i] = s.xx;
    out.sxy[i] = s.xy;
    out.syy[i] = s.yy;
  }
}

void update(const LandmarkRows& l, const CameraRows& camera, int particles, const Sight& sight) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Gain g = covariance_times_h(l, v, i);
    const Symmetric2 s = with_noise(innovation(g, v), sight);
    const float inverse_det = 1.0F / (s.xx * s.yy - s.xy * s.xy);
    const float wxx = s.yy * inverse_det;
    const float wxy = -s.xy * inverse_det;
    const float wyy = s.xx * inverse_det;
    const float nx = sight.zx - v.mx;
    const float ny = sight.zy - v.my;
    // K = P H^T S^-1
    const float kx0 = g.x0 * wxx + g.x1 * wxy;
    const float kx1 = g.x0 * wxy + g.x1 * wyy;
    const float ky0 = g.y0 * wxx + g.y1 * wxy;
    const float ky1 = g.y0 * wxy + g.y1 * wyy;
    const float kr0 = g.r0 * wxx + g.r1 * wxy;
    const float kr1 = g.r0 * wxy + g.r1 * wyy;
    l.ax[i] += kx0 * nx + kx1 * ny;
    l.ay[i] += ky0 * nx + ky1 * ny;
    l.rho[i] += kr0 * nx + kr1 * ny;
    // P -= K (P H^T)^T; the variances stay above a floor that rounding cannot cross.
    constexpr float kFloor = 1e-9F;
    l.pxx[i] = std::max(l.pxx[i] - (kx0 * g.x0 + kx1 * g.x1), kFloor);
    l.pxy[i] -= kx0 * g.y0 + kx1 * g.y1;
    l.pxr[i] -= kx0 * g.r0 + kx1 * g.r1;
    l.pyy[i] = std::max(l.pyy[i] - (ky0 * g.y0 + ky1 * g.y1), kFloor);
    l.pyr[i] -= ky0 * g.r0 + ky1 * g.r1;
    l.prr[i] = std::max(l.prr[i] - (kr0 * g.r0 + kr1 * g.r1), kFloor);
  }
}

void add_log_likelihood(const LandmarkRows& l, const CameraRows& camera, int particles,
                        const Sight& sight, float cap, double* log_likelihood) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Gain g = covariance_times_h(l, v, i);
    const Symmetric2 s = with_shared(with_noise(innovation(g, v), sight), g, sight);
    const float det = s.xx * s.yy - s.xy * s.xy;
    const float nx = sight.zx - v.mx;
    const float ny = sight.zy - v.my;
    const float d2 = (s.yy * nx * nx - 2.0F * s.xy * nx * ny + s.xx * ny * ny) / det;
    log_likelihood[i] -= static_cast<double>(0.5F * (std::min(d2, cap) + row_log(det)));
  }
}

void add_to_proposal(const LandmarkRows& l, const CameraRows& camera, int particles,
                     float lever_x_m, float lever_y_m, const Sight& sight, float rho,
                     float* const* rows) {
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Gain g = covariance_times_h(l, v, i);
    const Symmetric2 s = with_noise(innovation(g, v), sight);
    const float det = s.xx * s.yy - s.xy * s.xy;
    const float wxx = s.yy / det;
    const float wxy = -s.xy / det;
    const float wyy = s.xx / det;
    const float gx = v.my + rho * lever_y_m;
    const float gy = -(v.mx + rho * lever_x_m);
    const float nx = sight.zx - v.mx;
    const float ny = sight.zy - v.my;
    const float ex = wxx * nx + wxy * ny;
    const float ey = wxy * nx + wyy * ny;
    const float tx = wxx * gx + wxy * gy;
    const float ty = wxy * gx + wyy * gy;
    rows[0][i] += rho * rho * wxx;
    rows[1][i] += rho * rho * wxy;
    rows[2][i] -= rho * tx;
    rows[3][i] += rho * rho * wyy;
    rows[4][i] -= rho * ty;
    rows[5][i] += gx * tx + gy * ty;
    rows[6][i] -= rho * ex;
    rows[7][i] -= rho * ey;
    rows[8][i] += gx * ex + gy * ey;
    rows[9][i] += nx * ex + ny * ey;
    rows[10][i] += row_log(det);
    if (sight.shared == 0.0F) continue;
    const float ux = sight.shared * g.r0;
    const float uy = sight.shared * g.r1;
    const float qx = wxx * ux + wxy * uy;
    const float qy = wxy * ux + wyy * uy;
    rows[11][i] -= rho * qx;
    rows[12][i] -= rho * qy;
    rows[13][i] += gx * qx + gy * qy;
    rows[14][i] += ux * qx + uy * qy;
    rows[15][i] += nx * qx + ny * qy;
  }
}

void marginalise_shared(int particles, float* const* rows) {
  for (int i = 0; i < particles; ++i) {
    const float a = rows[11][i];
    const float b = rows[12][i];
    const float c = rows[13][i];
    const float information = 1.0F + rows[14][i];
    const float pa = a / information;
    const float pb = b / information;
    const float pc = c / information;
    const float e = rows[15][i];
    rows[0][i] -= a * pa;
    rows[1][i] -= a * pb;
    rows[2][i] -= a * pc;
    rows[3][i] -= b * pb;
    rows[4][i] -= b * pc;
    rows[5][i] -= c * pc;
    rows[6][i] -= pa * e;
    rows[7][i] -= pb * e;
    rows[8][i] -= pc * e;
    rows[9][i] -= e * e / information;
    rows[10][i] += row_log(information);
    for (int k = 11; k < 16; ++k) rows[k][i] = 0.0F;
  }
}

// A sum over the particles, in parts.
struct Sum {
  double parts[kPartialSums] = {};
  void add(int particle, double term) { parts[particle % kPartialSums] += term; }
  double total() const {
    const double* p = parts;
    return ((p[0] + p[4]) + (p[2] + p[6])) + ((p[1] + p[5]) + (p[3] + p[7]));
  }
};

PredictionSums predict_sums(const LandmarkRows& l, const CameraRows& camera, const double* weight,
                            int particles) {
  Sum mx, my, mxx, mxy, myy, sxx, sxy, syy, rho;
  for (int i = 0; i < particles; ++i) {
    const View v = view(l, camera, i);
    const Symmetric2 s = innovation(covariance_times_h(l, v, i), v);
    const double w = weight[i];
    const double x = v.mx;
    const double y = v.my;
    mx.add(i, w * x);
    my.add(i, w * y);
    mxx.add(i, w * x * x);
    mxy.add(i, w * x * y);
    myy.add(i, w * y * y);
    sxx.add(i, w * static_cast<double>(s.xx));
    sxy.add(i, w * static_cast<double>(s.xy));
    syy.add(i, w * static_cast<double>(s.yy));
    rho.add(i, w * static_cast<double>(l.rho[i]));
  }
  return {mx.total(),  my.total(),  mxx.total(), mxy.total(), myy.total(),
          sxx.total(), sxy.total(), syy.total(), rho.total()};
}

// Where a landmark is: L = c_a + R(theta_a) (ax, ay) / rho, and its height above the camera.
struct Place {
  double x, y, h, ca, sa, ex, ey, rho;
};

Place place(const LandmarkRows& l, int i, double min_rho) {
  Place p;
  p.rho = l.rho[i];
  p.h = 1.0 / std::max(p.rho, min_rho);
  p.ca = l.anchor_cos[i];
  p.sa = l.anchor_sin[i];
  const double ax = l.ax[i];
  const double ay = l.ay[i];
  p.ex = p.ca * ax - p.sa * ay;
  p.ey = p.sa * ax + p.ca * ay;
  p.x = static_cast<double>(l.anchor_x[i]) + p.ex * p.h;
  p.y = static_cast<double>(l.anchor_y[i]) + p.ey * p.h;
  return p;
}

PlaceSums place_sums(const LandmarkRows& l, const double* weight, int particles, double min_rho) {
  PlaceSums out = {};
  const Place first = place(l, 0, min_rho);
  out.origin[0] = first.x;
  out.origin[1] = first.y;
  out.origin[2] = first.h;
  Sum mean[3], second[6], rho, rho2;
  for (int i = 0; i < particles; ++i) {
    const Place p = place(l, i, min_rho);
    const double w = weight[i];
    const double dx = p.x - first.x;
    const double dy = p.y - first.y;
    const double dz = p.h - first.h;
    const double pxx = l.pxx[i];
    const double pxy = l.pxy[i];
    const double pxr = l.pxr[i];
    const double pyy = l.pyy[i];
    const double pyr = l.pyr[i];
    const double prr = l.prr[i];
    // J = dL / d(ax, ay, rho) = [a -b -f; b a -g; 0 0 -q], then J P, then J P J^T.
    const double a = p.ca * p.h;
    const double b = p.sa * p.h;
    const double q = p.h * p.h;
    const double f = p.ex * q;
    const double g = p.ey * q;
    const double xx = a * pxx - b * pxy - f * pxr;
    const double xy = a * pxy - b * pyy - f * pyr;
    const double xr = a * pxr - b * pyr - f * prr;
    const double yx = b * pxx + a * pxy - g * pxr;
    const double yy = b * pxy + a * pyy - g * pyr;
    const double yr = b * pxr + a * pyr - g * prr;
    mean[0].add(i, w * dx);
    mean[1].add(i, w * dy);
    mean[2].add(i, w * dz);
    second[0].add(i, w * (dx * dx + (xx * a - xy * b - xr * f)));
    second[1].add(i, w * (dx * dy + (xx * b + xy * a - xr * g)));
    second[2].add(i, w * (dx * dz - xr * q));
    second[3].add(i, w * (dy * dy + (yx * b + yy * a - yr * g)));
    second[4].add(i, w * (dy * dz - yr * q));
    second[5].add(i, w * (dz * dz + q * prr * q));
    rho.add(i, w * p.rho);
    rho2.add(i, w * (p.rho * p.rho + prr));
  }
  for (int j = 0; j < 3; ++j) out.mean[j] = mean[j].total();
  for (int j = 0; j < 6; ++j) out.second[j] = second[j].total();
  out.rho = rho.total();
  out.rho2 = rho2.total();
  return out;
}

}  // namespace

const RowTable kRowsScalar = {Isa::kScalar,       predict,         predict_sums,       update,
                              add_log_likelihood, add_to_proposal, marginalise_shared, place_sums};

}  // namespace zenith
