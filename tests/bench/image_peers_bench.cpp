// What one would take from OpenCV for the image stage, on the frame of image_bench.cpp, one thread.
// OpenCV takes memory for each call; by default the C library gives it back to the kernel each
// time. The first argument, 1, keeps it instead.

#include <malloc.h>

#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "slam/image/rectify.h"
#include "tests/bench/rendered_drive.h"

namespace zenith::bench {
namespace {

constexpr std::size_t kFrame = 120;

void keep_memory(bool keep) {
  mallopt(M_MMAP_THRESHOLD, keep ? 1 << 30 : 128 << 10);
  mallopt(M_TRIM_THRESHOLD, keep ? 1 << 30 : 128 << 10);
}

cv::Mat rectified() {
  static ExtractorRig extractor(corridor_rooms().robot);
  extractor->extract(corridor_rooms().image(kFrame));
  const ImageView image = extractor->rectified();
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.data),
                 static_cast<std::size_t>(image.stride))
      .clone();
}

// With OpenCV's fixed-point maps, its faster kind.
void opencv_remap(benchmark::State& state) {
  cv::setNumThreads(1);
  keep_memory(state.range(0) != 0);
  const RobotConfig& robot = corridor_rooms().robot;
  const Pinhole pinhole = Pinhole::from_fov(2.0944);
  const Eigen::Matrix3d R = mount_rotation(robot.mount).transpose();
  cv::Mat map_u(kRectifiedSize, kRectifiedSize, CV_32F);
  cv::Mat map_v(kRectifiedSize, kRectifiedSize, CV_32F);
  for (int v = 0; v < kRectifiedSize; ++v) {
    for (int u = 0; u < kRectifiedSize; ++u) {
      const Eigen::Vector2d m = pinhole.normalise(u, v);
      const Eigen::Vector2d at = robot.lens.project(R * Eigen::Vector3d(m.x(), m.y(), 1.0));
      map_u.at<float>(v, u) = static_cast<float>(at.x());
      map_v.at<float>(v, u) = static_cast<float>(at.y());
    }
  }
  cv::Mat fixed;
  cv::Mat weights;
  cv::convertMaps(map_u, map_v, fixed, weights, CV_16SC2);
  const ImageView frame = corridor_rooms().image(kFrame);
  const cv::Mat in(frame.height, frame.width, CV_8U, const_cast<std::uint8_t*>(frame.data),
                   static_cast<std::size_t>(frame.stride));
  cv::Mat out;
  for (auto _ : state) {
    cv::remap(in, out, fixed, weights, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    benchmark::DoNotOptimize(out.data);
  }
}
BENCHMARK(opencv_remap)->ArgName("kept")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void opencv_corner_harris(benchmark::State& state) {
  cv::setNumThreads(1);
  keep_memory(state.range(0) != 0);
  const cv::Mat image = rectified();
  cv::Mat response;
  for (auto _ : state) {
    cv::cornerHarris(image, response, static_cast<int>(state.range(1)), 3, 0.04);
    benchmark::DoNotOptimize(response.data);
  }
}
BENCHMARK(opencv_corner_harris)
    ->ArgNames({"kept", "window"})
    ->ArgsProduct({{0, 1}, {3, 7}})
    ->Unit(benchmark::kMicrosecond);

void opencv_good_features(benchmark::State& state) {
  cv::setNumThreads(1);
  keep_memory(state.range(0) != 0);
  const cv::Mat image = rectified();
  std::vector<cv::Point2f> corners;
  for (auto _ : state) {
    cv::goodFeaturesToTrack(image, corners, 128, 0.01, 6.0, cv::noArray(),
                            static_cast<int>(state.range(1)), true, 0.04);
    benchmark::DoNotOptimize(corners.data());
  }
  state.counters["corners"] = static_cast<double>(corners.size());
}
BENCHMARK(opencv_good_features)
    ->ArgNames({"kept", "window"})
    ->ArgsProduct({{0, 1}, {3, 7}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace zenith::bench
