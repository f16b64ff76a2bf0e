#pragma once
// Included by one file for each instruction set: see match_peer_eigen.h.
#define Eigen ZENITH_PEER_SET
#include <Eigen/Core>
#include <Eigen/LU>

#include "tests/bench/update_peer.h"

namespace zenith::bench {
namespace {

void update(std::span<PeerParticle> particles, float zx, float zy, float noise) {
  for (PeerParticle& p : particles) {
    Eigen::Map<Eigen::Vector3f> x(p.x);
    Eigen::Map<Eigen::Matrix3f> P(p.P);
    Eigen::Matrix2f camera;
    camera << p.camera_cos, -p.camera_sin, p.camera_sin, p.camera_cos;
    Eigen::Matrix2f anchor;
    anchor << p.anchor_cos, -p.anchor_sin, p.anchor_sin, p.anchor_cos;
    const Eigen::Vector2f d(p.anchor_x - p.camera_x, p.anchor_y - p.camera_y);
    Eigen::Matrix<float, 2, 3> H;
    H.leftCols<2>() = camera.transpose() * anchor;
    H.col(2) = camera.transpose() * d;
    const Eigen::Matrix<float, 3, 2> PHt = P * H.transpose();
    const Eigen::Matrix2f S = H * PHt + noise * Eigen::Matrix2f::Identity();
    const Eigen::Matrix<float, 3, 2> K = PHt * S.inverse();
    x += K * (Eigen::Vector2f(zx, zy) - H * x);
    P -= K * PHt.transpose();
  }
}

}  // namespace

extern const UpdatePeer ZENITH_PEER;
const UpdatePeer ZENITH_PEER = {ZENITH_PEER_NAME, update};

}  // namespace zenith::bench
