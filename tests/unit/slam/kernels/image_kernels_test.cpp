// Every instruction set that this processor has gives the same bits as the specification.
#include "slam/kernels/image/image_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/isas_here.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

// An image that ends with its last byte; rows at odd distances.
struct Image {
  enum class Kind { kNoise, kSmooth, kConstant, kExtreme };

  Image(Random& random, Kind kind, int columns, int rows)
      : width(columns), height(rows), stride(columns + static_cast<int>(random.below(7))) {
    bytes.resize(static_cast<std::size_t>((height - 1) * stride + width));
    const double a = random.uniform(0.02, 0.3);
    const double b = random.uniform(0.02, 0.3);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const auto u = static_cast<double>(i % static_cast<std::size_t>(stride));
      const auto v = static_cast<double>(i / static_cast<std::size_t>(stride));
      double value = 128.0;
      if (kind == Kind::kNoise) value = random.uniform(0.0, 256.0);
      if (kind == Kind::kSmooth) value = 128.0 + 60.0 * std::sin(a * u + b * v) * std::cos(b * u);
      if (kind == Kind::kExtreme) value = random.uniform() < 0.5 ? 0.0 : 255.0;
      bytes[i] = static_cast<std::uint8_t>(value);
    }
  }
  int width;
  int height;
  int stride;
  std::vector<std::uint8_t> bytes;
};
constexpr Image::Kind kKinds[] = {Image::Kind::kNoise, Image::Kind::kSmooth, Image::Kind::kConstant,
                                  Image::Kind::kExtreme};

template <typename T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(ImageKernels, EveryPathOfThisProcessorIsItsOwn) {
  for (const Isa isa : isas_here()) {
    const Isa expected = isa == Isa::kNeonDotprod ? Isa::kNeon : isa;
    EXPECT_EQ(image_table(isa).isa, expected) << isa_name(isa);
  }
}

TEST(ImageKernels, RemapIsTheSameOnEveryPath) {
  const TestSeed seed;
  Random random(seed.value());
  for (const Image::Kind kind : kKinds) {
    for (int round = 0; round < 20; ++round) {
      const Image image(random, kind, 40 + static_cast<int>(random.below(60)), 35);
      for (const int count : {0, 1, 3, 4, 7, 8, 15, 16, 17, 33, 320, 321}) {
        std::vector<RemapEntry> entries(static_cast<std::size_t>(count));
        for (RemapEntry& e : entries) {
          if (random.uniform() < 0.1) continue;
          // All that build() would accept, the last places included.
          const bool low = random.uniform() < 0.3;
          e.v = static_cast<std::uint16_t>(low ? image.height - 2 : random.below(33));
          const int last = low ? image.width - kRemapReads : image.width - 2;
          e.u = static_cast<std::uint16_t>(random.uniform() < 0.3 ? last : random.below(30));
          e.weight_u = static_cast<std::uint8_t>(random.below(129));
          e.weight_v = static_cast<std::uint8_t>(random.below(129));
          e.inside = 1;
        }
        const auto run = [&](const ImageTable& table) {
          std::vector<std::uint8_t> out(entries.size() + 1, 77);
          table.remap(image.bytes.data(), image.stride, entries.data(), count, out.data());
          return out;
        };
        const auto expected = run(kImageScalar);
        EXPECT_EQ(expected.back(), 77);
        for (const Isa isa : isas_here()) {
          ASSERT_TRUE(same(run(image_table(isa)), expected)) << isa_name(isa) << ", " << count;
        }
      }
    }
  }
}

TEST(ImageKernels, ResponseAndPeaksAreTheSameOnEveryPath) {
  const TestSeed seed;
  Random random(seed.value());
  std::size_t peaks_seen = 0;
  for (const Image::Kind kind : kKinds) {
    for (const int size : {27, 32, 33, 47, 64, 101, 320}) {
      const Image image(random, kind, size, size);
      const auto plane = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
      struct Result {
        std::vector<float> response;
        std::vector<std::int32_t> places;
      };
      const auto run = [&](const ImageTable& table, float min_eigenvalue, int border, int room) {
        Result r{std::vector<float>(plane, -1.0F), std::vector<std::int32_t>(8192)};
        std::vector<float> scratch(harris_scratch(size), 1e30F);
        table.harris(image.bytes.data(), image.stride, size, min_eigenvalue, r.response.data(),
                     scratch.data());
        const int count = table.peaks(r.response.data(), size, border, r.places.data(), room);
        r.places.resize(static_cast<std::size_t>(count));
        return r;
      };
      for (const float min_eigenvalue : {0.0F, 5.0F, 200.0F}) {
        for (const int room : {size + 3, 8192}) {
          const int border = 4 + static_cast<int>(random.below(4));
          const Result expected = run(kImageScalar, min_eigenvalue, border, room);
          peaks_seen += expected.places.size();
          for (const Isa isa : isas_here()) {
            const Result got = run(image_table(isa), min_eigenvalue, border, room);
            ASSERT_TRUE(same(got.response, expected.response)) << isa_name(isa) << ", " << size;
            ASSERT_EQ(got.places, expected.places) << isa_name(isa) << ", " << size;
          }
        }
      }
    }
  }
  EXPECT_GT(peaks_seen, 1000U);
}

TEST(ImageKernels, PatchesAreTheSameOnEveryPath) {
  const TestSeed seed;
  Random random(seed.value());
  DctTable dct = {};
  for (int k = 0; k < kDctKept; ++k) {
    for (int i = 0; i < kPatchSide; ++i) {
      dct.by_frequency[k][i] = dct.by_place[i][k] = static_cast<float>(random.uniform(-1.0, 1.0));
    }
  }
  for (auto& pair : dct.order) {
    for (std::uint8_t& f : pair) f = static_cast<std::uint8_t>(random.below(kDctKept));
  }
  int with_contrast = 0;
  for (const Image::Kind kind : kKinds) {
    for (int round = 0; round < 100; ++round) {
      const Image image(random, kind, 25 + static_cast<int>(random.below(30)),
                        25 + static_cast<int>(random.below(30)));
      const auto place = [&](int size) {
        const double most = size - 1 - kPatchMargin;
        const double at = random.uniform(kPatchMargin, most);
        return static_cast<float>(random.uniform() < 0.2 ? most : at);
      };
      const float u = place(image.width);
      const float v = place(image.height);
      const double angle = random.uniform(-4.0, 4.0);
      struct Result {
        CentroidSums sums;
        float norm;
        std::int8_t values[kPatchSide * kPatchSide];
        float compact_norm;
        std::int8_t compact[kCompactValues];
      };
      const auto run = [&](const ImageTable& table) {
        Result r;
        std::memset(&r, 0, sizeof r);
        const int cu = static_cast<int>(std::lround(u));
        const int cv = static_cast<int>(std::lround(v));
        r.sums = table.centroid(image.bytes.data(), image.stride, cu, cv,
                                u - static_cast<float>(cu), v - static_cast<float>(cv));
        r.norm =
            table.patch(image.bytes.data(), image.stride, u, v, static_cast<float>(std::cos(angle)),
                        static_cast<float>(std::sin(angle)), 1.0F, r.values);
        r.compact_norm = table.compact(dct, r.values, r.compact);
        return r;
      };
      const Result expected = run(kImageScalar);
      with_contrast += expected.norm > 0.0F ? 1 : 0;
      for (const Isa isa : isas_here()) {
        const Result got = run(image_table(isa));
        ASSERT_EQ(std::memcmp(&got, &expected, sizeof got), 0)
            << isa_name(isa) << ", kind " << static_cast<int>(kind) << ", round " << round;
      }
    }
  }
  EXPECT_GT(with_contrast, 200);
}

}  // namespace
}  // namespace zenith
