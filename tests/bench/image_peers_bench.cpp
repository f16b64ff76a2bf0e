// What one would take from OpenCV for the image stage, on the frame of image_bench.cpp, one thread.
// OpenCV takes memory for each call; by default the C library gives it back to the kernel each
// time. The first argument, 1, keeps it instead.

#include <malloc.h>

#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "tests/bench/opencv_maps.h"
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
  return as_mat(extractor->rectified()).clone();
}

// With OpenCV's fixed-point maps, its faster kind.
void opencv_remap(benchmark::State& state) {
  cv::setNumThreads(1);
  keep_memory(state.range(0) != 0);
  const OpenCvMaps maps(corridor_rooms().robot);
  const cv::Mat in = as_mat(corridor_rooms().image(kFrame));
  cv::Mat out;
  for (auto _ : state) {
    cv::remap(in, out, maps.places, maps.weights, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
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
