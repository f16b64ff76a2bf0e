// What one would build instead of Slam::step() from OpenCV and Eigen, with as much to do as
// step_bench.cpp has: about 110 corners, 157 predicted landmarks of four looks, 80 updated for 200
// particles, and one peer's map searched in each frame. Left out, in its favour: the likelihoods,
// the proposal, the copying of maps when particles are drawn anew, and all that follows a search.

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "platform/base/random.h"
#include "tests/bench/match_peers.h"
#include "tests/bench/opencv_maps.h"
#include "tests/bench/rendered_drive.h"
#include "tests/bench/update_peer.h"

namespace zenith::bench {
namespace {

constexpr std::size_t kFirst = 15;  // before, the robot stands
constexpr int kCorners = 110;
constexpr int kPredicted = 157;
constexpr int kLooks = 4;
constexpr int kUpdated = 80;
constexpr int kParticles = 200;
constexpr int kObserved = 60;
constexpr int kPeerLooks = 2000 * kLooks;
constexpr int kSide = 16;
constexpr int kValues = kSide * kSide;

class Pipeline {
 public:
  Pipeline(const GemmPeer& gemm, const UpdatePeer& update)
      : gemm_(gemm), update_(update), maps_(corridor_rooms().robot), particles_(kParticles) {
    Random random(3);
    for (auto* looks : {&own_, &peer_}) {
      looks->resize(static_cast<std::size_t>(looks == &own_ ? kPredicted * kLooks : kPeerLooks) *
                    kValues);
      for (float& v : *looks) v = static_cast<float>(random.normal() / kSide);
    }
    for (PeerParticle& p : particles_) {
      p = {{0.1F, 0.2F, 0.4F},
           {0.01F, 0, 0, 0, 0.01F, 0, 0, 0, 0.02F},
           0,
           0,
           1,
           0,
           0.3F,
           0.1F,
           1,
           0};
    }
  }

  void step(const ImageView& frame, bool search) {
    cv::remap(as_mat(frame), image_, maps_.places, maps_.weights, cv::INTER_LINEAR,
              cv::BORDER_CONSTANT);
    cv::goodFeaturesToTrack(image_, corners_, kCorners, 1e-4, 6.0, cv::noArray(), 3, true, 0.04);
    describe();
    match(own_, static_cast<int>(corners_.size()));
    for (int i = 0; i < kUpdated; ++i) update_.update(particles_, 0.12F, 0.21F, 1e-5F);
    if (search) match(peer_, std::min(kObserved, static_cast<int>(corners_.size())));
  }
  std::size_t corners() const { return corners_.size(); }

 private:
  // Patches turned to the direction of their centre of mass, of unit length.
  void describe() {
    patches_.clear();
    for (const cv::Point2f& p : corners_) {
      const int u = std::clamp(static_cast<int>(p.x), 9, image_.cols - 10);
      const int v = std::clamp(static_cast<int>(p.y), 9, image_.rows - 10);
      const cv::Moments m = cv::moments(image_(cv::Rect(u - 8, v - 8, 17, 17)));
      const double angle = std::atan2(m.m01 / m.m00 - 8.0, m.m10 / m.m00 - 8.0);
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      const double half = 0.5 * (kSide - 1);
      const cv::Matx23d to_image(c, -s, static_cast<double>(p.x) - half * (c - s), s, c,
                                 static_cast<double>(p.y) - half * (s + c));
      cv::warpAffine(image_, patch_, to_image, cv::Size(kSide, kSide),
                     cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
      patch_.convertTo(values_, CV_32F, 1.0, -cv::mean(patch_)[0]);
      cv::normalize(values_, values_);
      patches_.insert(patches_.end(), values_.ptr<float>(), values_.ptr<float>() + kValues);
    }
  }
  void match(const std::vector<float>& looks, int queries) {
    const int count = static_cast<int>(looks.size()) / kValues;
    products_.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(queries));
    gemm_.multiply(looks.data(), count, patches_.data(), queries, kValues, products_.data());
    for (int q = 0; q < queries; ++q) {
      benchmark::DoNotOptimize(
          gemm_.largest(products_.data() + static_cast<std::ptrdiff_t>(q) * count, count));
    }
  }

  GemmPeer gemm_;
  UpdatePeer update_;
  OpenCvMaps maps_;
  std::vector<float> own_;
  std::vector<float> peer_;
  std::vector<PeerParticle> particles_;
  cv::Mat image_;
  cv::Mat patch_;
  cv::Mat values_;
  std::vector<cv::Point2f> corners_;
  std::vector<float> patches_;
  std::vector<float> products_;
};

void pipeline(benchmark::State& state, const GemmPeer& gemm, const UpdatePeer& update) {
  cv::setNumThreads(1);
  Pipeline pipeline(gemm, update);
  const RenderedDrive& drive = corridor_rooms();
  std::size_t frame = kFirst;
  double corners = 0.0;
  for (auto _ : state) {
    pipeline.step(drive.image(frame), state.range(0) != 0);
    corners += static_cast<double>(pipeline.corners());
    if (++frame == drive.frames.size()) frame = kFirst;
  }
  state.counters["corners"] = corners / static_cast<double>(state.iterations());
}

const bool registered = [] {
  for (const GemmPeer& gemm : gemm_peers()) {
    for (const UpdatePeer& update : update_peers()) {
      if (std::string(gemm.name) != update.name) continue;
      benchmark::RegisterBenchmark(("pipeline/opencv/" + std::string(gemm.name)).c_str(), pipeline,
                                   gemm, update)
          ->ArgName("search")
          ->Arg(0)
          ->Arg(1)
          ->Iterations(250)
          ->Unit(benchmark::kMillisecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace zenith::bench
