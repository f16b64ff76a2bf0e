#pragma once
// What the filter does with rows of particles: one landmark, all particles (paper-notes; paper Eq.
// 1). The model, its symbols and its sources: slam/filter/landmark.h and slam/filter/proposal.h.
//
// A row holds one component for every particle: floats, padded to a multiple of kRowAlign; rows of
// one call do not overlap. Kernels may read and write the padding, whose values mean nothing.
//
// Every instruction set does the same operations in the same order without fused multiply-adds, so
// all give the same bits; sums over particles are kept in kPartialSums parts, particle i in part i
// mod kPartialSums, which are then added as ((p0+p4)+(p2+p6))+((p1+p5)+(p3+p7)). On 32-bit
// ARM the compiler takes lanes of floats one by one, for the sake of the same bits.
//
// No heap, no state.

#include "platform/base/isa.h"

namespace zenith {

inline constexpr int kRowAlign = 16;  // floats: one AVX-512 register
inline constexpr int kPartialSums = 8;

// One landmark with its anchor.
struct LandmarkRows {
  float* ax;
  float* ay;
  float* rho;
  float* pxx;
  float* pxy;
  float* pxr;
  float* pyy;
  float* pyr;
  float* prr;
  const float* anchor_x;
  const float* anchor_y;
  const float* anchor_cos;
  const float* anchor_sin;
};

// The camera centre in the plane and the robot's heading.
struct CameraRows {
  float* x = nullptr;
  float* y = nullptr;
  float* cos = nullptr;
  float* sin = nullptr;
};

// Prediction of one landmark: m, and S without the measurement noise.
struct PredictionRows {
  float* mx = nullptr;
  float* my = nullptr;
  float* sxx = nullptr;
  float* sxy = nullptr;
  float* syy = nullptr;
};

// A landmark's observation z with its variance on each axis, and how much it has in common with
// others: u = shared * (P H^T)_rho, in the units of z (slam/filter/depth_prior.h).
struct Sight {
  float zx = 0.0F;
  float zy = 0.0F;
  float noise = 0.0F;
  float shared = 0.0F;
};

// Weighted sums of a prediction over the particles.
struct PredictionSums {
  double mx, my, mxx, mxy, myy, sxx, sxy, syy, rho;
};

// Weighted sums of a landmark's places relative to `origin`, the first particle's: d, and the upper
// triangle (xx, xy, xz, yy, yz, zz) of d d^T + J P J^T; and of rho and rho^2 + var(rho).
struct PlaceSums {
  double origin[3];
  double mean[3];
  double second[6];
  double rho;
  double rho2;
};

struct RowTable {
  Isa isa;

  void (*predict)(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                  const PredictionRows& out);
  PredictionSums (*predict_sums)(const LandmarkRows& landmark, const CameraRows& camera,
                                 const double* weight, int particles);
  void (*update)(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                 const Sight& sight);
  // log_likelihood -= (min(d^2, cap) + log det S) / 2, S with u u^T; as long as a padded row.
  void (*add_log_likelihood)(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                             const Sight& sight, float cap, double* log_likelihood);
  // Adds one landmark, with G of `rho`, to the eleven rows of the proposal, and, unless `shared` is
  // 0, to the five that follow: sum G^T S^-1 u (3), u^T S^-1 u, u^T S^-1 nu.
  void (*add_to_proposal)(const LandmarkRows& landmark, const CameraRows& camera, int particles,
                          float lever_x_m, float lever_y_m, const Sight& sight, float rho,
                          float* const* rows);
  // Marginalises what landmarks shared: the five rows go into the eleven, and are zero again.
  void (*marginalise_shared)(int particles, float* const* rows);
  // rho below `min_rho` counts as that; heights are above the camera.
  PlaceSums (*place_sums)(const LandmarkRows& landmark, const double* weight, int particles,
                          double min_rho);
};

const RowTable& row_table(Isa isa);
const RowTable& rows_in_use();

// The natural logarithm as the kernels compute it: Cephes' logf (S. L. Moshier, 1992), within 1e-7
// of the value plus 1e-7. What is below the smallest normal number counts as that.
float row_log(float x);

extern const RowTable kRowsScalar;
extern const RowTable kRowsSse41;
extern const RowTable kRowsAvx2;
extern const RowTable kRowsAvx512;
extern const RowTable kRowsNeon;

}  // namespace zenith
