// The kernels of the image stage, on a rendered frame of corridor-rooms.

#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "slam/image/corners.h"
#include "slam/image/ncc.h"
#include "slam/image/rectify.h"
#include "tests/bench/rendered_drive.h"

namespace zenith::bench {
namespace {

constexpr std::size_t kFrame = 120;
constexpr std::size_t kPlane = kRectifiedSize * kRectifiedSize;
constexpr float kMinEigenvalue = 5.0F;  // Parameters::corner_min_eigenvalue

void rectify(benchmark::State& state) {
  const RenderedDrive& drive = corridor_rooms();
  Rectifier rectifier;
  const ArenaBlock block([&](Arena& arena) { rectifier.layout(arena); });
  rectifier.build(drive.robot.lens, drive.robot.mount, Pinhole::from_fov(2.0944));
  std::vector<std::uint8_t> out(kPlane);
  for (auto _ : state) {
    rectifier.apply(drive.image(kFrame),
                    {out.data(), kRectifiedSize, kRectifiedSize, kRectifiedSize});
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(rectify)->Unit(benchmark::kMicrosecond);

// The rectified image and its features, of one frame.
struct Described {
  Described() : extractor(corridor_rooms().robot) {
    features = &extractor->extract(corridor_rooms().image(kFrame));
  }
  ExtractorRig extractor;
  const Features* features;
};

void harris_response(benchmark::State& state) {
  Described frame;
  std::vector<float> response(kPlane);
  std::vector<float> scratch(harris_scratch(kRectifiedSize));
  const ImageView image = frame.extractor->rectified();
  for (auto _ : state) {
    image_kernels().harris(image.data, image.stride, kRectifiedSize, kMinEigenvalue,
                           response.data(), scratch.data());
    benchmark::DoNotOptimize(response.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(harris_response)->Unit(benchmark::kMicrosecond);

void detect_corners(benchmark::State& state) {
  Described frame;
  CornerDetector detector;
  const ArenaBlock block([&](Arena& arena) { detector.layout(arena); });
  CornerSettings settings;
  settings.min_eigenvalue = kMinEigenvalue;
  Corners corners;
  for (auto _ : state) {
    detector.detect(frame.extractor->rectified(), settings, corners);
    benchmark::DoNotOptimize(corners.size());
  }
  state.counters["corners"] = static_cast<double>(corners.size());
}
BENCHMARK(detect_corners)->Unit(benchmark::kMicrosecond);

void patches_128(benchmark::State& state) {
  Described frame;
  const Features& features = *frame.features;
  const ImageView image = frame.extractor->rectified();
  for (auto _ : state) {
    for (std::size_t i = 0; i < 128; ++i) {
      const Feature& f = features[i % features.size()];
      const float direction = patch_orientation(image, f.u_px, f.v_px);
      benchmark::DoNotOptimize(sample_patch(image, f.u_px, f.v_px, direction));
    }
  }
}
BENCHMARK(patches_128)->Unit(benchmark::kMicrosecond);

void compact_128(benchmark::State& state) {
  Described frame;
  const Features& features = *frame.features;
  for (auto _ : state) {
    for (std::size_t i = 0; i < 128; ++i) {
      benchmark::DoNotOptimize(compact(features[i % features.size()].patch));
    }
  }
}
BENCHMARK(compact_128)->Unit(benchmark::kMicrosecond);

// One patch against 1000, in nanoseconds a pair.
template <typename Descriptor>
void ncc_1000(benchmark::State& state, const Descriptor Feature::*descriptor) {
  Described frame;
  const Features& features = *frame.features;
  std::vector<Descriptor> stored;
  for (std::size_t i = 0; i < 1000; ++i) {
    stored.push_back(features[i % features.size()].*descriptor);
  }
  const Descriptor query = stored.front();
  for (auto _ : state) {
    float sum = 0.0F;
    for (const Descriptor& s : stored) sum += ncc(query, s);
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK_CAPTURE(ncc_1000, full_256, &Feature::patch)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ncc_1000, compact_32, &Feature::compact)->Unit(benchmark::kMicrosecond);

void extract_features(benchmark::State& state) {
  ExtractorRig extractor(corridor_rooms().robot);
  for (auto _ : state) {
    benchmark::DoNotOptimize(extractor->extract(corridor_rooms().image(kFrame)).size());
  }
}
BENCHMARK(extract_features)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace zenith::bench
