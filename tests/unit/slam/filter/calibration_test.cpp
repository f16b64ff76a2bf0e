// The calibration's sensitivities against numbers, and that what they learn is the truth.

#include "slam/filter/calibration.h"

#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "slam/image/lens.h"
#include "tests/support/landmark_rig.h"
#include "tests/support/seeds.h"

namespace zenith {
namespace {

constexpr double kNoise = 1.2e-4;
constexpr double kStep = 1e-6;
const Eigen::Vector2d kLever(0.12, -0.07);

Eigen::Vector2d tangents(const Eigen::Vector3d& ray) {
  return ray.head<2>() / ray.z();
}

// C(z) against the geometry: a camera that leans forward or to the left, and an equidistant lens
// whose focal length is larger than believed or whose principal point lies elsewhere; derivatives
// by central differences.
TEST(Calibration, EffectIsTheDerivativeOfTheGeometry) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector2d z(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
    const Eigen::Vector3d ray(z.x(), z.y(), 1.0);
    const auto turned = [&](const Eigen::Vector3d& axis, double angle) {
      return tangents(Eigen::AngleAxisd(angle, axis) * ray);
    };
    const auto stretched = [&](double share) -> Eigen::Vector2d {
      const double r = z.norm();
      return z * std::tan(std::atan(r) * (1.0 + share)) / r;
    };
    const auto shifted = [&](const Eigen::Vector2d& by) -> Eigen::Vector2d {
      const double r = z.norm();
      const Eigen::Vector2d q = std::atan(r) / r * z + by;  // in the fisheye image
      return std::tan(q.norm()) / q.norm() * q;
    };
    SightSensitivity numeric;
    // To lean forward is to turn about y, to lean left about -x.
    numeric.col(0) =
        turned(Eigen::Vector3d::UnitY(), kStep) - turned(Eigen::Vector3d::UnitY(), -kStep);
    numeric.col(1) =
        turned(-Eigen::Vector3d::UnitX(), kStep) - turned(-Eigen::Vector3d::UnitX(), -kStep);
    numeric.col(2) = stretched(kStep) - stretched(-kStep);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector2d by = kStep * Eigen::Vector2d::Unit(i);
      numeric.col(3 + i) = shifted(by) - shifted(-by);
    }
    numeric /= 2.0 * kStep;
    ASSERT_LT((calibration_effect(z) - numeric).norm(), 1e-7) << z.transpose();
  }
  EXPECT_TRUE(calibration_effect(Eigen::Vector2d::Zero()).allFinite());
}

// One observation as a function of everything that it depends on.
struct Sight {
  Pose2 anchor;
  Pose2 robot;
  LandmarkGaussian landmark;

  Eigen::Vector2d m(const Eigen::Vector3d& d_landmark, const Eigen::Vector3d& d_robot,
                    const Eigen::Vector3d& d_anchor) const {
    const auto moved = [](const Pose2& p, const Eigen::Vector3d& d) {
      const Pose2 q = {p.x_m + d[0], p.y_m + d[1], p.theta_rad + d[2]};
      return CameraPose{q * kLever, rotation(q.theta_rad)};
    };
    return reference_h(moved(anchor, d_anchor), moved(robot, d_robot)) * (landmark.x + d_landmark);
  }
};

struct Rig {
  LandmarkRig landmark{1};
  CameraRig camera{1};
  Sight sight;

  explicit Rig(Random& random) {
    sight = {random_pose(random, 1.0), random_pose(random, 1.0),
             random_landmark(random, 0.01, 0.03)};
    const auto camera_pose = [](const Pose2& p) {
      const Eigen::Vector2d c = p * kLever;
      return Pose2{c.x(), c.y(), p.theta_rad};
    };
    landmark.anchor.set(0, camera_pose(sight.anchor));
    landmark.set(0, sight.landmark);
    camera.set(0, camera_pose(sight.robot));
  }
  ObservationModel model() { return linearise(landmark.rows(), camera.rows(), 0, kLever, kNoise); }
};

TEST(Calibration, ObservationJacobiansAgreeWithNumbers) {
  const TestSeed seed;
  Random random(seed.value());
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  for (int trial = 0; trial < 200; ++trial) {
    Rig rig(random);
    const ObservationModel model = rig.model();
    Eigen::Matrix<double, 2, 3> H;
    Eigen::Matrix<double, 2, 3> J_t;
    Eigen::Matrix<double, 2, 3> J_a;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = kStep * Eigen::Vector3d::Unit(i);
      const Sight& s = rig.sight;
      H.col(i) = (s.m(e, none, none) - s.m(-e, none, none)) / (2.0 * kStep);
      J_t.col(i) = (s.m(none, e, none) - s.m(none, -e, none)) / (2.0 * kStep);
      J_a.col(i) = (s.m(none, none, e) - s.m(none, none, -e)) / (2.0 * kStep);
    }
    ASSERT_LT((model.by_landmark - H).norm(), 1e-5) << "trial " << trial;
    ASSERT_LT((model.by_pose - J_t).norm(), 1e-5) << "trial " << trial;
    ASSERT_LT((model.by_anchor - J_a).norm(), 1e-5) << "trial " << trial;
    const Eigen::Matrix3d P = rig.landmark.get(0).P;
    const Eigen::Matrix2d S = H * P * H.transpose() + kNoise * Eigen::Matrix2d::Identity();
    const Eigen::Matrix<double, 3, 2> K = P * H.transpose() * S.inverse();
    ASSERT_LT((model.gain - K).norm(), 1e-4 * K.norm()) << "trial " << trial;
  }
}

// D = d (z - m) / d beta when landmark, pose and anchor each move with beta by their own
// sensitivity, and what is seen is z_true - C beta.
TEST(Calibration, ResidualSensitivityAgreesWithNumbers) {
  const TestSeed seed;
  Random random(seed.value());
  const auto random_matrix = [&random] {
    PoseSensitivity M;
    for (double& x : M.reshaped()) x = random.uniform(-1.0, 1.0);
    return M;
  };
  for (int trial = 0; trial < 200; ++trial) {
    Rig rig(random);
    const LandmarkSensitivity B = random_matrix();
    const PoseSensitivity A_t = random_matrix();
    const PoseSensitivity A_a = random_matrix();
    const Eigen::Vector2d z(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    const auto residual = [&](const CalibrationVector& beta) -> Eigen::Vector2d {
      return z - calibration_effect(z) * beta - rig.sight.m(B * beta, A_t * beta, A_a * beta);
    };
    SightSensitivity numeric;
    for (int i = 0; i < kCalibrationSize; ++i) {
      const CalibrationVector e = kStep * CalibrationVector::Unit(i);
      numeric.col(i) = (residual(e) - residual(-e)) / (2.0 * kStep);
    }
    const auto D = residual_sensitivity(rig.model(), z, B, A_t, A_a);
    ASSERT_LT((D - numeric).norm(), 2e-5) << "trial " << trial;
  }
}

// Whatever the calibration has wrong, a landmark that is seen again from its anchor's pose is seen
// where it was before: that tells nothing of beta, and must not be taken for agreement with zero.
TEST(Calibration, TheSameSightAgainTellsNothing) {
  const TestSeed seed;
  Random random(seed.value());
  for (int trial = 0; trial < 50; ++trial) {
    Rig rig(random);
    const Pose2 pose = rig.sight.anchor;
    const Eigen::Vector2d c = pose * kLever;
    rig.camera.set(0, {c.x(), c.y(), pose.theta_rad});
    const Eigen::Vector2d z = rig.landmark.get(0).x.head<2>();
    PoseSensitivity A;
    for (double& x : A.reshaped()) x = random.uniform(-1.0, 1.0);
    const auto D = residual_sensitivity(rig.model(), z, starting_sensitivity(z), A, A);
    ASSERT_LT(D.norm(), 1e-5) << "trial " << trial;
  }
}

// A landmark 2.5 m above the camera, anywhere in view: how its residual depends on the pose and on
// the calibration.
struct Derivatives {
  Eigen::Matrix<double, 2, 3> G;
  SightSensitivity D;
};

Derivatives random_sight(Random& random) {
  const Eigen::Vector2d z(random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3));
  Derivatives sight;
  sight.G << -0.4, 0.0, z.y(), 0.0, -0.4, -z.x();
  sight.D = -calibration_effect(z);
  return sight;
}

// Residuals made from a known beta and unknown pose errors: the estimate comes to it, and each
// frame's verdict leaves out what the pose explains.
TEST(Calibration, EstimatorFindsTheTruth) {
  const TestSeed seed;
  Random random(seed.value());
  CalibrationVector truth;
  truth << 0.002, -0.0015, 0.0, -0.001, 0.0005;
  CalibrationEstimator estimator;
  estimator.reset({.tilt_rad = 0.004, .focal = 0.0, .principal = 0.002});
  ASSERT_TRUE(estimator.enabled());
  const double before = estimator.covariance()(0, 0);
  const Eigen::Matrix2d weight = Eigen::Matrix2d::Identity() / kNoise;
  for (int frame = 0; frame < 400; ++frame) {
    const Eigen::Vector3d xi(0.01 * random.normal(), 0.01 * random.normal(),
                             0.01 * random.normal());
    estimator.begin_frame(Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal());
    for (int n = 0; n < 30; ++n) {
      const auto [G, D] = random_sight(random);
      const Eigen::Vector2d noise(random.normal(), random.normal());
      estimator.add(0, D * (truth - estimator.beta()) + G * xi + std::sqrt(kNoise) * noise, G, D,
                    weight, Eigen::Vector2d::Zero());
    }
    estimator.end_frame();
    estimator.pay(1.0);
  }
  const CalibrationVector error = estimator.beta() - truth;
  const CalibrationMatrix P = estimator.covariance();
  EXPECT_LT(P(0, 0), 0.2 * before);
  for (const int i : {0, 1, 3, 4}) EXPECT_LT(std::abs(error[i]), 5.0 * std::sqrt(P(i, i))) << i;
  // Tilt and principal point are nearly the same; their sum is known far better than each.
  const double sum_variance = P(0, 0) + 2.0 * P(0, 3) + P(3, 3);
  EXPECT_LT(sum_variance, 0.01 * before);
  EXPECT_LT(std::abs(error[0] + error[3]), 5.0 * std::sqrt(sum_variance));
}

// The pose's share of a frame, with beta marginalised out, equals the joint normal equations.
TEST(Calibration, PoseGainSolvesTheNormalEquations) {
  const TestSeed seed;
  Random random(seed.value());
  CalibrationEstimator estimator;
  estimator.reset({.tilt_rad = 0.004, .focal = 0.0, .principal = 0.0});
  const Eigen::Matrix3d prior = Eigen::Vector3d(3e3, 2e3, 1e3).asDiagonal();
  estimator.begin_frame(prior);
  Eigen::Matrix3d xx = prior;
  PoseSensitivity xb = PoseSensitivity::Zero();
  for (int n = 0; n < 10; ++n) {
    const auto [G, D] = random_sight(random);
    const Eigen::Matrix2d W = Eigen::Vector2d(5e3, 8e3).asDiagonal();
    estimator.add(0, Eigen::Vector2d::Zero(), G, D, W, Eigen::Vector2d::Zero());
    xx += G.transpose() * W * G;
    xb += G.transpose() * W * D;
  }
  const PoseSensitivity expected = xx.inverse() * xb;
  EXPECT_LT((estimator.pose_gain() - expected).norm(), 1e-9 * expected.norm());
}

// What cannot be learned leaves what was learned, and the estimator begins again when told to.
TEST(Calibration, AStepThatIsNoNumberIsNotTaken) {
  const auto frame = [](CalibrationEstimator& estimator, double residual) {
    estimator.begin_frame(1e4 * Eigen::Matrix3d::Identity());
    for (int n = 0; n < 30; ++n) {
      const Eigen::Vector2d z(0.1 * (n % 7 - 3), 0.2 * (n % 5 - 2));
      Eigen::Matrix<double, 2, 3> G;
      G << -0.4, 0.0, z.y(), 0.0, -0.4, -z.x();
      estimator.add(0, residual * Eigen::Vector2d(1.0 + z.x(), z.y()), G, -calibration_effect(z),
                    1e4 * Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero());
    }
    estimator.end_frame();
    return estimator.pay(1.0);
  };
  CalibrationEstimator estimator;
  estimator.reset({.tilt_rad = 0.004, .focal = 0.01, .principal = 0.004});
  frame(estimator, 1e-3);
  const CalibrationVector learned = estimator.beta();
  EXPECT_FALSE(learned.isZero(0.0));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_TRUE(frame(estimator, bad).isZero(0.0)) << bad;
    EXPECT_TRUE(estimator.broken());
    EXPECT_EQ(estimator.beta(), learned);
    estimator.restart();
    EXPECT_FALSE(frame(estimator, 1e-3).isZero(0.0));
    EXPECT_FALSE(estimator.broken());
    EXPECT_TRUE(estimator.covariance().allFinite());
    estimator.reset({.tilt_rad = 0.004, .focal = 0.01, .principal = 0.004});
    frame(estimator, 1e-3);
  }
}

TEST(Calibration, ZeroTiltSwitchesItOff) {
  CalibrationEstimator estimator;
  estimator.reset({.tilt_rad = 0.0, .focal = 0.01, .principal = 0.01});
  EXPECT_FALSE(estimator.enabled());
  EXPECT_TRUE(estimator.beta().isZero(0.0));
}

// What is owed is neither lost nor learned twice: paid in parts, the estimate ends where it would
// have been at once.
TEST(CalibrationEstimator, PaysWhatItOwesInParts) {
  const TestSeed seed;
  const auto learn = [&](double share) {
    Random random(seed.value());
    CalibrationEstimator estimator;
    estimator.reset({0.01, 0.0, 0.01});
    CalibrationVector truth;
    truth << 0.012, -0.008, 0.0, 0.004, -0.006;
    for (int frame = 0; frame < 120; ++frame) {
      estimator.begin_frame(Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal());
      for (int n = 0; n < 30; ++n) {
        const auto [G, D] = random_sight(random);
        estimator.add(0, D * (truth - estimator.beta()), G, D, 1e5 * Eigen::Matrix2d::Identity(),
                      Eigen::Vector2d::Zero());
      }
      estimator.end_frame();
      estimator.pay(share);
    }
    return CalibrationVector(estimator.beta() + estimator.owed());
  };
  EXPECT_LT((learn(0.1) - learn(1.0)).norm(), 1e-6);
}

// A closing whose jump the calibration explains tells it, as far as drift leaves that open, and is
// not heard again in the next frame.
TEST(CalibrationEstimator, AClosingCountsOnce) {
  CalibrationEstimator estimator;
  estimator.reset({.tilt_rad = 0.004, .focal = 0.0, .principal = 0.0});
  PoseSensitivity by_calibration = PoseSensitivity::Zero();
  by_calibration(0, 0) = 100.0;
  CalibrationVector truth = CalibrationVector::Zero();
  truth[0] = 0.004;
  const double drift_m = 0.2;
  const auto frame = [&](bool closing) {
    estimator.begin_frame(1e4 * Eigen::Matrix3d::Identity());
    if (closing) {
      estimator.add_closing(by_calibration * truth, by_calibration,
                            drift_m * drift_m * Eigen::Matrix3d::Identity());
    }
    estimator.end_frame();
    return CalibrationVector(estimator.pay(1.0));
  };
  // The prior leaves 0.4 m open and the drift 0.2 m: four fifths of the jump are the calibration's.
  EXPECT_NEAR(frame(true)[0], 0.8 * truth[0], 0.001 * truth[0]);
  EXPECT_TRUE(frame(false).isZero(1e-12));
  EXPECT_LT(estimator.covariance()(0, 0), 0.21 * 0.004 * 0.004);
}

}  // namespace
}  // namespace zenith
