#pragma once
// The row kernels over lanes. For the kernels' own files: see lanes.h. The scalar version,
// rows_scalar.cpp, says the same without lanes.
//
// kLanes floats are calculated with at once; where sums are kept, kPartialSums in vectors of
// kFloats floats and kDoubles doubles.

#include "slam/kernels/lanes.h"
#include "slam/kernels/rows/rows.h"

namespace zenith {
namespace {

template <typename F>
struct View {
  F c, s, bx, by, mx, my;
};
template <typename F>
struct Gain {
  F x0, x1, y0, y1, r0, r1;
};
template <typename F>
struct Symmetric2 {
  F xx, xy, yy;
};

// What is loaded of a landmark and of the cameras, particles i to i + N - 1.
template <int N>
struct Landmark {
  using F = Floats<N>;
  F ax, ay, rho, pxx, pxy, pxr, pyy, pyr, prr;
  ZENITH_INLINE Landmark(const LandmarkRows& l, int i)
      : ax(load<N>(l.ax + i)),
        ay(load<N>(l.ay + i)),
        rho(load<N>(l.rho + i)),
        pxx(load<N>(l.pxx + i)),
        pxy(load<N>(l.pxy + i)),
        pxr(load<N>(l.pxr + i)),
        pyy(load<N>(l.pyy + i)),
        pyr(load<N>(l.pyr + i)),
        prr(load<N>(l.prr + i)) {}
};

template <int N>
ZENITH_INLINE View<Floats<N>> view(const LandmarkRows& rows, const Landmark<N>& l,
                                   const CameraRows& camera, int i) {
  using F = Floats<N>;
  const F ct = load<N>(camera.cos + i);
  const F st = load<N>(camera.sin + i);
  const F ca = load<N>(rows.anchor_cos + i);
  const F sa = load<N>(rows.anchor_sin + i);
  const F c = ca * ct + sa * st;
  const F s = sa * ct - ca * st;
  const F dx = load<N>(rows.anchor_x + i) - load<N>(camera.x + i);
  const F dy = load<N>(rows.anchor_y + i) - load<N>(camera.y + i);
  const F bx = ct * dx + st * dy;
  const F by = ct * dy - st * dx;
  return {c, s, bx, by, c * l.ax - s * l.ay + l.rho * bx, s * l.ax + c * l.ay + l.rho * by};
}

template <int N>
ZENITH_INLINE Gain<Floats<N>> covariance_times_h(const Landmark<N>& l, const View<Floats<N>>& v) {
  return {l.pxx * v.c - l.pxy * v.s + l.pxr * v.bx, l.pxx * v.s + l.pxy * v.c + l.pxr * v.by,
          l.pxy * v.c - l.pyy * v.s + l.pyr * v.bx, l.pxy * v.s + l.pyy * v.c + l.pyr * v.by,
          l.pxr * v.c - l.pyr * v.s + l.prr * v.bx, l.pxr * v.s + l.pyr * v.c + l.prr * v.by};
}

template <typename F>
ZENITH_INLINE Symmetric2<F> innovation(const Gain<F>& g, const View<F>& v) {
  return {v.c * g.x0 - v.s * g.y0 + v.bx * g.r0, v.c * g.x1 - v.s * g.y1 + v.bx * g.r1,
          v.s * g.x1 + v.c * g.y1 + v.by * g.r1};
}

template <typename F>
ZENITH_INLINE Symmetric2<F> with_noise(const Symmetric2<F>& s, const Sight& sight) {
  return {s.xx + sight.noise, s.xy, s.yy + sight.noise};
}

template <typename F>
ZENITH_INLINE Symmetric2<F> with_shared(const Symmetric2<F>& s, const Gain<F>& g,
                                        const Sight& sight) {
  const F ux = sight.shared * g.r0;
  const F uy = sight.shared * g.r1;
  return {s.xx + ux * ux, s.xy + ux * uy, s.yy + uy * uy};
}

// See row_log().
template <int N>
ZENITH_INLINE Floats<N> log_of(const Floats<N>& given) {
  using F = Floats<N>;
  using I = Ints<N>;
  const F x = larger(given, F{} + 1.17549435e-38F);
  const I bits = reinterpret_cast<I>(x);
  // x = m 2^e with m in [1/2, 1), then in [sqrt(1/2), sqrt(2)).
  I e = (bits >> 23) - 126;
  const I mantissa = (bits & 0x007fffff) | 0x3f000000;
  F m = reinterpret_cast<F>(mantissa);
  const I low = m < F{} + 0.707106781186547524F;
  e += low;  // -1 where true
  m = low ? m + m : m;
  const F z = m - 1.0F;
  const F z2 = z * z;
  F p = z * 7.0376836292e-2F - 1.1514610310e-1F;
  p = p * z + 1.1676998740e-1F;
  p = p * z - 1.2420140846e-1F;
  p = p * z + 1.4249322787e-1F;
  p = p * z - 1.6668057665e-1F;
  p = p * z + 2.0000714765e-1F;
  p = p * z - 2.4999993993e-1F;
  p = p * z + 3.3333331174e-1F;
  const F fe = __builtin_convertvector(e, F);
  F y = z * z2 * p;
  y = y + fe * -2.12194440e-4F;
  y = y - z2 * 0.5F;
  return z + y + fe * 0.693359375F;
}

template <int kLanes, int kFloats, int kDoubles>
struct RowKernels {
  using F = Floats<kLanes>;

  static void predict(const LandmarkRows& rows, const CameraRows& camera, int particles,
                      const PredictionRows& out) {
    for (int i = 0; i < particles; i += kLanes) {
      const Landmark<kLanes> l(rows, i);
      const auto v = view(rows, l, camera, i);
      const auto s = innovation(covariance_times_h(l, v), v);
      store<kLanes>(out.mx + i, v.mx);
      store<kLanes>(out.my + i, v.my);
      store<kLanes>(out.sxx + i, s.xx);
      store<kLanes>(out.sxy + i, s.xy);
      store<kLanes>(out.syy + i, s.yy);
    }
  }

  static void update(const LandmarkRows& rows, const CameraRows& camera, int particles,
                     const Sight& sight) {
    for (int i = 0; i < particles; i += kLanes) {
      const Landmark<kLanes> l(rows, i);
      const auto v = view(rows, l, camera, i);
      const auto g = covariance_times_h(l, v);
      const auto s = with_noise(innovation(g, v), sight);
      const F inverse_det = 1.0F / (s.xx * s.yy - s.xy * s.xy);
      const F wxx = s.yy * inverse_det;
      const F wxy = -s.xy * inverse_det;
      const F wyy = s.xx * inverse_det;
      const F nx = sight.zx - v.mx;
      const F ny = sight.zy - v.my;
      const F kx0 = g.x0 * wxx + g.x1 * wxy;
      const F kx1 = g.x0 * wxy + g.x1 * wyy;
      const F ky0 = g.y0 * wxx + g.y1 * wxy;
      const F ky1 = g.y0 * wxy + g.y1 * wyy;
      const F kr0 = g.r0 * wxx + g.r1 * wxy;
      const F kr1 = g.r0 * wxy + g.r1 * wyy;
      const F floor = F{} + 1e-9F;
      store<kLanes>(rows.ax + i, l.ax + (kx0 * nx + kx1 * ny));
      store<kLanes>(rows.ay + i, l.ay + (ky0 * nx + ky1 * ny));
      store<kLanes>(rows.rho + i, l.rho + (kr0 * nx + kr1 * ny));
      store<kLanes>(rows.pxx + i, larger(l.pxx - (kx0 * g.x0 + kx1 * g.x1), floor));
      store<kLanes>(rows.pxy + i, l.pxy - (kx0 * g.y0 + kx1 * g.y1));
      store<kLanes>(rows.pxr + i, l.pxr - (kx0 * g.r0 + kx1 * g.r1));
      store<kLanes>(rows.pyy + i, larger(l.pyy - (ky0 * g.y0 + ky1 * g.y1), floor));
      store<kLanes>(rows.pyr + i, l.pyr - (ky0 * g.r0 + ky1 * g.r1));
      store<kLanes>(rows.prr + i, larger(l.prr - (kr0 * g.r0 + kr1 * g.r1), floor));
    }
  }

  static void add_log_likelihood(const LandmarkRows& rows, const CameraRows& camera, int particles,
                                 const Sight& sight, float cap, double* log_likelihood) {
    for (int i = 0; i < particles; i += kLanes) {
      const Landmark<kLanes> l(rows, i);
      const auto v = view(rows, l, camera, i);
      const auto g = covariance_times_h(l, v);
      const auto s = with_shared(with_noise(innovation(g, v), sight), g, sight);
      const F det = s.xx * s.yy - s.xy * s.xy;
      const F nx = sight.zx - v.mx;
      const F ny = sight.zy - v.my;
      const F d2 = (s.yy * nx * nx - 2.0F * s.xy * nx * ny + s.xx * ny * ny) / det;
      float half[kLanes];
      store<kLanes>(half, 0.5F * (smaller(d2, F{} + cap) + log_of<kLanes>(det)));
      for (int k = 0; k < kLanes; ++k) log_likelihood[i + k] -= static_cast<double>(half[k]);
    }
  }

  static ZENITH_INLINE void add(float* row, const F& more) {
    store<kLanes>(row, load<kLanes>(row) + more);
  }
  static ZENITH_INLINE void subtract(float* row, const F& less) {
    store<kLanes>(row, load<kLanes>(row) - less);
  }

  static void add_to_proposal(const LandmarkRows& rows, const CameraRows& camera, int particles,
                              float lever_x_m, float lever_y_m, const Sight& sight, float rho,
                              float* const* out) {
    for (int i = 0; i < particles; i += kLanes) {
      const Landmark<kLanes> l(rows, i);
      const auto v = view(rows, l, camera, i);
      const auto g = covariance_times_h(l, v);
      const auto s = with_noise(innovation(g, v), sight);
      const F det = s.xx * s.yy - s.xy * s.xy;
      const F wxx = s.yy / det;
      const F wxy = -s.xy / det;
      const F wyy = s.xx / det;
      const F gx = v.my + rho * lever_y_m;
      const F gy = -(v.mx + rho * lever_x_m);
      const F nx = sight.zx - v.mx;
      const F ny = sight.zy - v.my;
      const F ex = wxx * nx + wxy * ny;
      const F ey = wxy * nx + wyy * ny;
      const F tx = wxx * gx + wxy * gy;
      const F ty = wxy * gx + wyy * gy;
      add(out[0] + i, rho * rho * wxx);
      add(out[1] + i, rho * rho * wxy);
      subtract(out[2] + i, rho * tx);
      add(out[3] + i, rho * rho * wyy);
      subtract(out[4] + i, rho * ty);
      add(out[5] + i, gx * tx + gy * ty);
      subtract(out[6] + i, rho * ex);
      subtract(out[7] + i, rho * ey);
      add(out[8] + i, gx * ex + gy * ey);
      add(out[9] + i, nx * ex + ny * ey);
      add(out[10] + i, log_of<kLanes>(det));
      if (sight.shared == 0.0F) continue;
      const F ux = sight.shared * g.r0;
      const F uy = sight.shared * g.r1;
      const F qx = wxx * ux + wxy * uy;
      const F qy = wxy * ux + wyy * uy;
      subtract(out[11] + i, rho * qx);
      subtract(out[12] + i, rho * qy);
      add(out[13] + i, gx * qx + gy * qy);
      add(out[14] + i, ux * qx + uy * qy);
      add(out[15] + i, nx * qx + ny * qy);
    }
  }

  static void marginalise_shared(int particles, float* const* rows) {
    for (int i = 0; i < particles; i += kLanes) {
      const F a = load<kLanes>(rows[11] + i);
      const F b = load<kLanes>(rows[12] + i);
      const F c = load<kLanes>(rows[13] + i);
      const F information = 1.0F + load<kLanes>(rows[14] + i);
      const F pa = a / information;
      const F pb = b / information;
      const F pc = c / information;
      const F e = load<kLanes>(rows[15] + i);
      subtract(rows[0] + i, a * pa);
      subtract(rows[1] + i, a * pb);
      subtract(rows[2] + i, a * pc);
      subtract(rows[3] + i, b * pb);
      subtract(rows[4] + i, b * pc);
      subtract(rows[5] + i, c * pc);
      subtract(rows[6] + i, pa * e);
      subtract(rows[7] + i, pb * e);
      subtract(rows[8] + i, pc * e);
      subtract(rows[9] + i, e * e / information);
      add(rows[10] + i, log_of<kLanes>(information));
      for (int k = 11; k < 16; ++k) store<kLanes>(rows[k] + i, F{});
    }
  }

  // --- sums over the particles
  // --------------------------------------------------------------------

  using D = Doubles<kDoubles>;
  static constexpr int kVectors = kPartialSums / kDoubles;

  // One sum in its parts. In the last, incomplete block of particles only `count` parts are added
  // to.
  struct Sum {
    D parts[kVectors] = {};
    ZENITH_INLINE void add(int vector, const D& term, int count) {
      if (count >= kPartialSums) {
        parts[vector] += term;
        return;
      }
      for (int k = 0; k < kDoubles; ++k) {
        if (vector * kDoubles + k < count) parts[vector][k] += term[k];
      }
    }
    ZENITH_INLINE double total() const {
      double p[kPartialSums];
      __builtin_memcpy(p, parts, sizeof(p));
      return ((p[0] + p[4]) + (p[2] + p[6])) + ((p[1] + p[5]) + (p[3] + p[7]));
    }
  };
  static ZENITH_INLINE D doubles(const float* from) {
    return __builtin_convertvector(load<kDoubles>(from), D);
  }

  static PredictionSums predict_sums(const LandmarkRows& rows, const CameraRows& camera,
                                     const double* weight, int particles) {
    Sum mx, my, mxx, mxy, myy, sxx, sxy, syy, rho;
    for (int i = 0; i < particles; i += kPartialSums) {
      const int count = particles - i;
      float m[5][kPartialSums];
      for (int k = 0; k < kPartialSums; k += kFloats) {
        const Landmark<kFloats> l(rows, i + k);
        const auto v = view(rows, l, camera, i + k);
        const auto s = innovation(covariance_times_h(l, v), v);
        store<kFloats>(m[0] + k, v.mx);
        store<kFloats>(m[1] + k, v.my);
        store<kFloats>(m[2] + k, s.xx);
        store<kFloats>(m[3] + k, s.xy);
        store<kFloats>(m[4] + k, s.yy);
      }
      for (int v = 0; v < kVectors; ++v) {
        const int k = v * kDoubles;
        const D w = load<kDoubles>(weight + i + k);
        const D x = doubles(m[0] + k);
        const D y = doubles(m[1] + k);
        const D wx = w * x;
        const D wy = w * y;
        mx.add(v, wx, count);
        my.add(v, wy, count);
        mxx.add(v, wx * x, count);
        mxy.add(v, wx * y, count);
        myy.add(v, wy * y, count);
        sxx.add(v, w * doubles(m[2] + k), count);
        sxy.add(v, w * doubles(m[3] + k), count);
        syy.add(v, w * doubles(m[4] + k), count);
        rho.add(v, w * doubles(rows.rho + i + k), count);
      }
    }
    return {mx.total(),  my.total(),  mxx.total(), mxy.total(), myy.total(),
            sxx.total(), sxy.total(), syy.total(), rho.total()};
  }

  struct Place {
    D x, y, h, ca, sa, ex, ey, rho;
  };
  static ZENITH_INLINE Place place(const LandmarkRows& rows, int i, double min_rho) {
    Place p;
    p.rho = doubles(rows.rho + i);
    p.h = 1.0 / larger(p.rho, D{} + min_rho);
    p.ca = doubles(rows.anchor_cos + i);
    p.sa = doubles(rows.anchor_sin + i);
    const D ax = doubles(rows.ax + i);
    const D ay = doubles(rows.ay + i);
    p.ex = p.ca * ax - p.sa * ay;
    p.ey = p.sa * ax + p.ca * ay;
    p.x = doubles(rows.anchor_x + i) + p.ex * p.h;
    p.y = doubles(rows.anchor_y + i) + p.ey * p.h;
    return p;
  }

  static PlaceSums place_sums(const LandmarkRows& rows, const double* weight, int particles,
                              double min_rho) {
    PlaceSums out = {};
    const Place first = place(rows, 0, min_rho);
    out.origin[0] = first.x[0];
    out.origin[1] = first.y[0];
    out.origin[2] = first.h[0];
    Sum mean[3], second[6], rho, rho2;
    for (int i = 0; i < particles; i += kPartialSums) {
      const int count = particles - i;
      for (int v = 0; v < kVectors; ++v) {
        const int k = i + v * kDoubles;
        const Place p = place(rows, k, min_rho);
        const D w = load<kDoubles>(weight + k);
        const D dx = p.x - out.origin[0];
        const D dy = p.y - out.origin[1];
        const D dz = p.h - out.origin[2];
        const D pxx = doubles(rows.pxx + k);
        const D pxy = doubles(rows.pxy + k);
        const D pxr = doubles(rows.pxr + k);
        const D pyy = doubles(rows.pyy + k);
        const D pyr = doubles(rows.pyr + k);
        const D prr = doubles(rows.prr + k);
        // J = [a -b -f; b a -g; 0 0 -q]
        const D a = p.ca * p.h;
        const D b = p.sa * p.h;
        const D q = p.h * p.h;
        const D f = p.ex * q;
        const D g = p.ey * q;
        const D xx = a * pxx - b * pxy - f * pxr;
        const D xy = a * pxy - b * pyy - f * pyr;
        const D xr = a * pxr - b * pyr - f * prr;
        const D yx = b * pxx + a * pxy - g * pxr;
        const D yy = b * pxy + a * pyy - g * pyr;
        const D yr = b * pxr + a * pyr - g * prr;
        mean[0].add(v, w * dx, count);
        mean[1].add(v, w * dy, count);
        mean[2].add(v, w * dz, count);
        second[0].add(v, w * (dx * dx + (xx * a - xy * b - xr * f)), count);
        second[1].add(v, w * (dx * dy + (xx * b + xy * a - xr * g)), count);
        second[2].add(v, w * (dx * dz - xr * q), count);
        second[3].add(v, w * (dy * dy + (yx * b + yy * a - yr * g)), count);
        second[4].add(v, w * (dy * dz - yr * q), count);
        second[5].add(v, w * (dz * dz + q * prr * q), count);
        rho.add(v, w * p.rho, count);
        rho2.add(v, w * (p.rho * p.rho + prr), count);
      }
    }
    for (int j = 0; j < 3; ++j) out.mean[j] = mean[j].total();
    for (int j = 0; j < 6; ++j) out.second[j] = second[j].total();
    out.rho = rho.total();
    out.rho2 = rho2.total();
    return out;
  }

  static constexpr RowTable table(Isa isa) {
    return {isa,
            predict,
            predict_sums,
            update,
            add_log_likelihood,
            add_to_proposal,
            marginalise_shared,
            place_sums};
  }
};

}  // namespace
}  // namespace zenith
