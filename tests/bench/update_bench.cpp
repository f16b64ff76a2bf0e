// The update of 200 particles x 50 landmarks: the row kernel of each instruction set beside Eigen's
// fixed-size matrices, in one run. Landmarks grow certain; the arithmetic stays the same.

#include <array>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "platform/base/random.h"
#include "slam/kernels/rows/rows.h"
#include "tests/bench/update_peer.h"
#include "tests/support/isas_here.h"

namespace zenith::bench {

extern const UpdatePeer kUpdateSse2;
#ifdef __x86_64__
extern const UpdatePeer kUpdateAvx2;
extern const UpdatePeer kUpdateAvx512;
#endif

std::vector<UpdatePeer> update_peers() {
  std::vector<UpdatePeer> peers = {kUpdateSse2};
#ifdef __x86_64__
  if (cpu_has(Isa::kAvx2)) peers.push_back(kUpdateAvx2);
  if (cpu_has(Isa::kAvx512)) peers.push_back(kUpdateAvx512);
#endif
  return peers;
}

namespace {

constexpr int kParticles = 200;
constexpr int kPadded = 208;
constexpr int kLandmarks = 50;
constexpr Sight kSight = {0.1F, -0.2F, 4e-5F};

std::vector<PeerParticle> particles_of_landmarks() {
  Random random(9);
  std::vector<PeerParticle> out;
  for (int i = 0; i < kLandmarks * kParticles; ++i) {
    const auto near = [&random](double mean, double sigma) {
      return static_cast<float>(mean + sigma * random.normal());
    };
    out.push_back({{near(0.5, 0.01), near(-0.2, 0.01), near(0.4, 0.02)},
                   {4e-5F, 0.0F, 0.0F, 0.0F, 4e-5F, 0.0F, 0.0F, 0.0F, 0.01F},
                   near(-1.0, 0.01),
                   near(0.0, 0.01),
                   1.0F,
                   0.0F,
                   near(0.0, 0.01),
                   near(0.0, 0.01),
                   1.0F,
                   0.0F});
  }
  return out;
}

void update_rows(benchmark::State& state, Isa isa) {
  const std::vector<PeerParticle> given = particles_of_landmarks();
  // 13 rows of each landmark, 4 of the cameras.
  std::vector<float> rows(kLandmarks * 13 * kPadded + 4 * kPadded, 1.0F);
  const auto row = [&rows](int landmark, int r) {
    return rows.data() + (landmark * 13 + r) * kPadded;
  };
  float* camera = rows.data() + kLandmarks * 13 * kPadded;
  for (int l = 0; l < kLandmarks; ++l) {
    for (int i = 0; i < kParticles; ++i) {
      const PeerParticle& p = given[static_cast<std::size_t>(l * kParticles + i)];
      const std::array<float, 13> all = {p.x[0],     p.x[1],       p.x[2],      p.P[0], p.P[1],
                                         p.P[2],     p.P[4],       p.P[5],      p.P[8], p.anchor_x,
                                         p.anchor_y, p.anchor_cos, p.anchor_sin};
      for (int r = 0; r < 13; ++r) row(l, r)[i] = all[static_cast<std::size_t>(r)];
      camera[i] = p.camera_x;
      camera[kPadded + i] = p.camera_y;
      camera[2 * kPadded + i] = p.camera_cos;
      camera[3 * kPadded + i] = p.camera_sin;
    }
  }
  const CameraRows cameras = {camera, camera + kPadded, camera + 2 * kPadded, camera + 3 * kPadded};
  const RowTable& table = row_table(isa);
  for (auto _ : state) {
    for (int l = 0; l < kLandmarks; ++l) {
      const LandmarkRows landmark = {row(l, 0),  row(l, 1),  row(l, 2), row(l, 3), row(l, 4),
                                     row(l, 5),  row(l, 6),  row(l, 7), row(l, 8), row(l, 9),
                                     row(l, 10), row(l, 11), row(l, 12)};
      table.update(landmark, cameras, kParticles, kSight);
    }
    benchmark::ClobberMemory();
  }
}

void update_eigen(benchmark::State& state, const UpdatePeer& peer) {
  std::vector<PeerParticle> particles = particles_of_landmarks();
  for (auto _ : state) {
    peer.update(particles, kSight.zx, kSight.zy, kSight.noise);
    benchmark::ClobberMemory();
  }
}

const bool registered = [] {
  for (const Isa isa : isas_here()) {
    benchmark::RegisterBenchmark(("update_rows/" + std::string(isa_name(isa))).c_str(), update_rows,
                                 isa)
        ->Unit(benchmark::kMicrosecond);
  }
  for (const UpdatePeer& peer : update_peers()) {
    benchmark::RegisterBenchmark(("update/" + std::string(peer.name)).c_str(), update_eigen, peer)
        ->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
}  // namespace zenith::bench
