#pragma once
// The Kalman update of one landmark after the other and one particle after the other, as one writes
// it with Eigen's fixed-size float matrices.

#include <span>
#include <vector>

namespace zenith::bench {

// A particle's idea of a landmark: state (ax, ay, rho), covariance row by row, anchor and camera
// pose.
struct PeerParticle {
  float x[3];
  float P[9];
  float anchor_x, anchor_y, anchor_cos, anchor_sin;
  float camera_x, camera_y, camera_cos, camera_sin;
};

struct UpdatePeer {
  const char* name;
  void (*update)(std::span<PeerParticle> particles, float zx, float zy, float noise);
};

std::vector<UpdatePeer> update_peers();  // that this processor can run

}  // namespace zenith::bench
