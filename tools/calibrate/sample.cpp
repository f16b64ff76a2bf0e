#include "tools/calibrate/sample.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/Geometry>

#include "platform/recording/png.h"
#include "platform/recording/sensor_file.h"
#include "sim/seed.h"
#include "tools/atomic_output.h"

namespace zenith::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadPerDeg = kPi / 180.0;
constexpr float kWhite = 1.0F;
constexpr float kBlack = 0.06F;
constexpr float kBehind = 0.35F;       // the room behind the board
constexpr double kPaperRim_m = 0.012;  // white round the squares
constexpr int kRaysAcross = 4;

RobotConfig robot_with(const Lens& lens) {
  RobotConfig robot;
  robot.lens = lens;
  robot.mount = {};
  return robot;
}

sim::CameraSpec spec_with(const Lens& lens) {
  sim::CameraSpec spec;
  spec.lens = lens;
  return spec;
}

// What is seen along a ray. The board's plane is where n . p = d.
class Paper {
 public:
  Paper(const BoardPose& pose, const Target& target, const cv::Mat& raster)
      : R_(pose.R_camera_board.cast<float>()),
        t_(pose.t_m.cast<float>()),
        d_(R_.col(2).dot(t_)),
        per_metre_(static_cast<float>(Target::kCellsPerSquare / target.square_m)),
        rim_(static_cast<float>(kPaperRim_m) * per_metre_),
        raster_(raster) {}

  float radiance(const Eigen::Vector3f& ray) const {
    const float slope = R_.col(2).dot(ray);
    const float distance = std::abs(slope) < 1e-6F ? -1.0F : d_ / slope;
    if (distance <= 0.0F) return kBehind;
    const Eigen::Vector3f from = distance * ray - t_;
    const float a = R_.col(0).dot(from) * per_metre_;
    const float b = R_.col(1).dot(from) * per_metre_;
    const auto columns = static_cast<float>(raster_.cols);
    const auto rows = static_cast<float>(raster_.rows);
    if (a < -rim_ || b < -rim_ || a >= columns + rim_ || b >= rows + rim_) return kBehind;
    if (a < 0.0F || b < 0.0F || a >= columns || b >= rows) return kWhite;
    return raster_.at<std::uint8_t>(static_cast<int>(b), static_cast<int>(a)) != 0 ? kWhite
                                                                                   : kBlack;
  }

 private:
  Eigen::Matrix3f R_;
  Eigen::Vector3f t_;
  float d_;
  float per_metre_;
  float rim_;
  const cv::Mat& raster_;
};

float pixel_radiance(const sim::PixelRay& pixel, const Paper& paper) {
  const Eigen::Map<const Eigen::Vector3f> d(pixel.d);
  const Eigen::Map<const Eigen::Vector3f> d_u(pixel.d_u);
  const Eigen::Map<const Eigen::Vector3f> d_v(pixel.d_v);
  float sum = 0.0F;
  for (int i = 0; i < kRaysAcross; ++i) {
    for (int j = 0; j < kRaysAcross; ++j) {
      const float du = (static_cast<float>(i) + 0.5F) / kRaysAcross - 0.5F;
      const float dv = (static_cast<float>(j) + 0.5F) / kRaysAcross - 0.5F;
      sum += paper.radiance(d + du * d_u + dv * d_v);
    }
  }
  return pixel.gain * sum / (kRaysAcross * kRaysAcross);
}

}  // namespace

Lens sample_lens(std::uint64_t seed) {
  Random random = sim::random_stream(seed, "sample lens");
  Lens lens;
  lens.fu_px = 150.0 * (1.0 + 0.03 * random.normal());
  lens.fv_px = lens.fu_px * (1.0 + 0.001 * random.normal());
  lens.cu_px = 319.5 + 4.0 * random.normal();
  lens.cv_px = 239.5 + 4.0 * random.normal();
  lens.k = {-0.012 + 0.004 * random.normal(), 0.004 + 0.002 * random.normal(), -0.0015, 0.0001};
  return lens;
}

SampleCamera::SampleCamera(const Lens& lens, const Target& target, std::uint64_t seed)
    : lens_(lens),
      target_(target),
      raster_(target_raster(target)),
      spec_(spec_with(lens)),
      camera_(robot_with(lens), spec_.field_deg, 180.0),
      sensor_(spec_, 0.0),
      random_(sim::random_stream(seed, "sample views")) {}

std::vector<std::uint8_t> SampleCamera::image(const BoardPose& pose) {
  const Paper paper(pose, target_, raster_);
  const auto width = static_cast<std::size_t>(camera_.width());
  std::vector<float> radiance(width * static_cast<std::size_t>(camera_.height()), 0.0F);
  for (int row = 0; row < camera_.height(); ++row) {
    const sim::PixelSpan& span = camera_.span(row);
    const sim::PixelRay* rays = camera_.rays(span);
    float* out = radiance.data() + static_cast<std::size_t>(row) * width;
    for (int u = span.first; u < span.last; ++u) {
      out[u] = pixel_radiance(rays[u - span.first], paper);
    }
  }
  std::vector<std::uint8_t> pixels;
  sensor_.develop(radiance, random_, pixels);
  return pixels;
}

bool SampleCamera::in_view(const BoardPose& pose) const {
  constexpr double kMargin_px = 4.0;
  for (const double a : {0.0, 0.5, 1.0}) {
    for (const double b : {0.0, 0.5, 1.0}) {
      const Eigen::Vector3d p = pose.in_camera({a * target_.width_m(), b * target_.height_m()});
      const Eigen::Vector2d uv = project_equidistant(lens_, p);
      if (uv.x() < kMargin_px || uv.x() > lens_.width_px - 1 - kMargin_px) return false;
      if (uv.y() < kMargin_px || uv.y() > lens_.height_px - 1 - kMargin_px) return false;
      const double angle = std::atan2(p.head<2>().norm(), p.z());
      if (angle > 0.5 * spec_.field_deg * kRadPerDeg - 0.05) return false;
    }
  }
  return true;
}

BoardPose SampleCamera::held(int index, int count) {
  // Rings from the axis out; the azimuth goes round by the golden angle.
  const double share = (index + 0.5) / count;
  for (double pull_in = 1.0;; pull_in *= 0.93) {
    const double off_axis = pull_in * 62.0 * kRadPerDeg * std::sqrt(share);
    const double azimuth = 2.39996 * index + random_.uniform(-0.2, 0.2);
    // Markers need more pixels than squares.
    const double nearness = target_.kind == TargetKind::kCharuco ? 0.6 : 1.0;
    const double distance = nearness * random_.uniform(0.8, 1.5) * target_.width_m();
    const Eigen::Vector3d towards(std::sin(off_axis) * std::cos(azimuth),
                                  std::sin(off_axis) * std::sin(azimuth), std::cos(off_axis));
    // Facing the camera, then leaning and turned.
    const Eigen::Quaterniond facing =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), towards);
    const double lean = random_.uniform(10.0, 40.0) * kRadPerDeg;
    const double side = random_.uniform(-kPi, kPi);
    const Eigen::AngleAxisd leaning(lean, Eigen::Vector3d(std::cos(side), std::sin(side), 0.0));
    const Eigen::AngleAxisd turned(random_.uniform(-0.4, 0.4), Eigen::Vector3d::UnitZ());
    BoardPose pose;
    pose.R_camera_board = (facing * leaning * turned).toRotationMatrix();
    const Eigen::Vector2d centre(0.5 * target_.width_m(), 0.5 * target_.height_m());
    pose.t_m = distance * towards - pose.R_camera_board.leftCols<2>() * centre;
    if (in_view(pose) || pull_in < 0.05) return pose;
  }
}

Status write_samples(const SamplePlan& plan, const std::filesystem::path& folder) {
  const Lens lens = sample_lens(plan.seed);
  SampleCamera camera(lens, plan.target, plan.seed);
  for (int i = 0; i < plan.views; ++i) {
    const auto pixels = camera.image(camera.held(i, plan.views));
    char name[32];
    std::snprintf(name, sizeof name, "view-%03d.png", i);
    const ImageView view{pixels.data(), lens.width_px, lens.height_px, lens.width_px};
    if (const Status written = write_grey_png(folder / name, view); !written) return written;
  }
  SensorFile truth;
  truth.lens = lens;
  return write_file(folder / "truth.yaml", format_sensor_file(truth));
}

}  // namespace zenith::tools
