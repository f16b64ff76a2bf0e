// Every instruction set that this processor has gives the same bits as the specification.
#include "slam/kernels/rows/rows.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "platform/base/random.h"
#include "tests/support/isas_here.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

int padded(int particles) {
  return (particles + kRowAlign - 1) / kRowAlign * kRowAlign;
}

// Powers of ten of wild values. NEON of 32-bit ARM takes numbers below 1e-38 for zero and the
// scalar path does not, nor do the two make the same NaN: there, products of some values must stay
// between.
#if defined(__arm__)
constexpr double kLeastSize = -1.0;
constexpr double kMostSize = 1.0;
#else
constexpr double kLeastSize = -30.0;
constexpr double kMostSize = 15.0;
#endif

// Rows at odd places in memory, with something behind them that must stay as it is.
class Rows {
 public:
  Rows(Random& random, int particles, bool wild) : particles_(particles) {
    const auto n = static_cast<std::size_t>(padded(particles));
    for (auto& row : rows_) row.resize(n + 2);
    for (auto& row : sums_) row.resize(n + 2);
    weight_.resize(n + 2);
    log_likelihood_.resize(n + 2);
    for (std::size_t i = 0; i < n + 2; ++i) fill(random, i, wild);
  }

  LandmarkRows landmark() {
    return {row(0), row(1), row(2), row(3),  row(4),  row(5), row(6),
            row(7), row(8), row(9), row(10), row(11), row(12)};
  }
  CameraRows camera() { return {row(13), row(14), row(15), row(16)}; }
  PredictionRows prediction() { return {row(17), row(18), row(19), row(20), row(21)}; }
  std::array<float*, 16> proposal() {
    std::array<float*, 16> out;
    for (std::size_t r = 0; r < out.size(); ++r) out[r] = sums_[r].data() + 1;
    return out;
  }
  const double* weight() const { return weight_.data() + 1; }
  double* log_likelihood() { return log_likelihood_.data() + 1; }

  // All values of particles are bit for bit the same, and what lies around the rows too.
  bool same_as(const Rows& other) const {
    const auto n = static_cast<std::size_t>(particles_);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      if (!same(rows_[r], other.rows_[r], n)) return false;
    }
    for (std::size_t r = 0; r < sums_.size(); ++r) {
      if (!same(sums_[r], other.sums_[r], n)) return false;
    }
    return same(log_likelihood_, other.log_likelihood_, n);
  }

 private:
  float* row(std::size_t r) { return rows_[r].data() + 1; }
  template <typename T>
  static bool same(const std::vector<T>& a, const std::vector<T>& b, std::size_t particles) {
    return std::memcmp(a.data(), b.data(), (particles + 1) * sizeof(T)) == 0 &&
           std::memcmp(&a.back(), &b.back(), sizeof(T)) == 0;
  }
  void fill(Random& random, std::size_t i, bool wild) {
    const double size = wild ? std::pow(10.0, random.uniform(kLeastSize, kMostSize)) : 1.0;
    const auto value = [&](double low, double high) {
      return static_cast<float>(size * random.uniform(low, high));
    };
    const double sx = random.uniform(1e-4, 0.1);
    const double sy = random.uniform(1e-4, 0.1);
    const double sr = random.uniform(1e-4, 0.1);
    const double anchor = random.uniform(-4.0, 4.0);
    const double heading = random.uniform(-4.0, 4.0);
    const std::array<float, 22> all = {value(-1.0, 1.0),
                                       value(-1.0, 1.0),
                                       value(0.0, 1.0),
                                       value(sx * sx, sx * sx),
                                       value(-0.3 * sx * sy, 0.3 * sx * sy),
                                       value(-0.3 * sx * sr, 0.3 * sx * sr),
                                       value(sy * sy, sy * sy),
                                       value(-0.3 * sy * sr, 0.3 * sy * sr),
                                       value(sr * sr, sr * sr),
                                       value(-5.0, 5.0),
                                       value(-5.0, 5.0),
                                       static_cast<float>(std::cos(anchor)),
                                       static_cast<float>(std::sin(anchor)),
                                       value(-5.0, 5.0),
                                       value(-5.0, 5.0),
                                       static_cast<float>(std::cos(heading)),
                                       static_cast<float>(std::sin(heading)),
                                       0.5F,
                                       0.5F,
                                       0.5F,
                                       0.5F,
                                       0.5F};
    for (std::size_t r = 0; r < all.size(); ++r) rows_[r][i] = all[r];
    for (auto& row : sums_) row[i] = value(-10.0, 10.0);
    weight_[i] = random.uniform();
    log_likelihood_[i] = random.uniform(-5.0, 0.0);
  }

  int particles_;
  std::array<std::vector<float>, 22> rows_;
  std::array<std::vector<float>, 16> sums_;
  std::vector<double> weight_;
  std::vector<double> log_likelihood_;
};

constexpr Sight kSight = {0.1F, -0.2F, 1.2e-4F};
constexpr Sight kShared = {0.1F, -0.2F, 1.2e-4F, 14.0F};

TEST(RowKernels, EveryPathOfThisProcessorIsItsOwn) {
  for (const Isa isa : isas_here()) {
    // What dotprod adds is for integers.
    const Isa expected = isa == Isa::kNeonDotprod ? Isa::kNeon : isa;
    EXPECT_EQ(row_table(isa).isa, expected) << isa_name(isa);
  }
}

TEST(RowKernels, EveryPathGivesTheBitsOfTheSpecification) {
  const TestSeed seed;
  Random random(seed.value());
  const auto run = [](const RowTable& table, Rows& rows, int n) {
    table.predict(rows.landmark(), rows.camera(), n, rows.prediction());
    table.add_log_likelihood(rows.landmark(), rows.camera(), n, kShared, 9.0F,
                             rows.log_likelihood());
    for (const Sight& sight : {kSight, kShared}) {
      table.add_to_proposal(rows.landmark(), rows.camera(), n, 0.06F, -0.02F, sight, 0.4F,
                            rows.proposal().data());
    }
    table.marginalise_shared(n, rows.proposal().data());
    table.update(rows.landmark(), rows.camera(), n, kSight);
  };
  for (int round = 0; round < 60; ++round) {
    for (const int n : {1, 2, 7, 8, 9, 15, 16, 17, 50, 200, 203}) {
      const Rows given(random, n, round % 4 == 3);
      Rows expected = given;
      run(kRowsScalar, expected, n);
      for (const Isa isa : isas_here()) {
        Rows got = given;
        run(row_table(isa), got, n);
        ASSERT_TRUE(got.same_as(expected))
            << isa_name(isa) << ", " << n << " particles, round " << round;
      }
    }
  }
}

TEST(RowKernels, SumsOverParticlesAreTheSameOnEveryPath) {
  const TestSeed seed;
  Random random(seed.value());
  for (int round = 0; round < 60; ++round) {
    for (const int n : {1, 2, 7, 8, 9, 15, 16, 17, 50, 200, 203}) {
      Rows rows(random, n, round % 4 == 3);
      const auto prediction =
          kRowsScalar.predict_sums(rows.landmark(), rows.camera(), rows.weight(), n);
      const auto place = kRowsScalar.place_sums(rows.landmark(), rows.weight(), n, 0.05);
      for (const Isa isa : isas_here()) {
        const RowTable& table = row_table(isa);
        const auto p = table.predict_sums(rows.landmark(), rows.camera(), rows.weight(), n);
        const auto q = table.place_sums(rows.landmark(), rows.weight(), n, 0.05);
        ASSERT_EQ(std::memcmp(&p, &prediction, sizeof p), 0) << isa_name(isa) << ", " << n;
        ASSERT_EQ(std::memcmp(&q, &place, sizeof q), 0) << isa_name(isa) << ", " << n;
      }
    }
  }
}

TEST(RowKernels, TheLogarithmIsNearTheTrueOne) {
  for (double x = 1.2e-38; x < 3e38; x *= 1.0007) {
    const auto given = static_cast<float>(x);
    const double expected = std::log(static_cast<double>(given));
    ASSERT_NEAR(static_cast<double>(row_log(given)), expected, 1e-7 + 1e-7 * std::abs(expected))
        << x;
  }
  EXPECT_EQ(row_log(1.0F), 0.0F);
  EXPECT_EQ(row_log(0.0F), row_log(std::numeric_limits<float>::min()));
  EXPECT_EQ(row_log(-1.0F), row_log(std::numeric_limits<float>::min()));
}

}  // namespace
}  // namespace zenith
