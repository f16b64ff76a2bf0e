#pragma once
// Included by one file for each instruction set, which says ZENITH_PEER_SET (a word for the name of
// its own copy of Eigen: code for one set must not be linked in place of another's), ZENITH_PEER
// and ZENITH_PEER_NAME.
#define Eigen ZENITH_PEER_SET
#include <Eigen/Core>

#include "tests/bench/match_peers.h"

namespace zenith::bench {
namespace {

void multiply(const float* looks, int look_count, const float* queries, int query_count, int length,
              float* products) {
  const Eigen::Map<const Eigen::MatrixXf> l(looks, length, look_count);
  const Eigen::Map<const Eigen::MatrixXf> q(queries, length, query_count);
  Eigen::Map<Eigen::MatrixXf> p(products, look_count, query_count);
  p.noalias() = l.transpose() * q;
}

float largest(const float* values, int count) {
  return Eigen::Map<const Eigen::VectorXf>(values, count).maxCoeff();
}

}  // namespace

extern const GemmPeer ZENITH_PEER;
const GemmPeer ZENITH_PEER = {ZENITH_PEER_NAME, multiply, largest};

}  // namespace zenith::bench
