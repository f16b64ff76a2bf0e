#include "tools/report/canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tools/atomic_output.h"

namespace zenith::tools {
namespace {

constexpr int kOversampling = 2;
constexpr int kShift = 4;  // bits of a pixel's fraction in OpenCV's drawing
constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kCapital_px = 22.0;  // height of this font's capitals at scale 1

cv::Scalar bgr(Colour colour) {
  return {static_cast<double>(colour.blue), static_cast<double>(colour.green),
          static_cast<double>(colour.red)};
}

cv::Point fine(const Eigen::Vector2d& p) {
  constexpr double kScale = kOversampling * (1 << kShift);
  const auto clamped = [](double v) { return static_cast<int>(std::clamp(v, -1e8, 1e8)); };
  return {clamped(std::round(p.x() * kScale)), clamped(std::round(p.y() * kScale))};
}

cv::Point whole(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::round(p.x() * kOversampling)),
          static_cast<int>(std::round(p.y() * kOversampling))};
}

int thick(double thickness) {
  return std::max(1, static_cast<int>(std::round(thickness * kOversampling)));
}

double font_scale(double size) {
  return size * kOversampling / kCapital_px;
}
int font_thickness(double size, bool bold) {
  return std::max(1, static_cast<int>(std::round(size * kOversampling * (bold ? 0.13 : 0.075))));
}

}  // namespace

Canvas::Canvas(int width_px, int height_px)
    : page_(height_px * kOversampling, width_px * kOversampling, CV_8UC3,
            cv::Scalar(255, 255, 255)),
      width_(width_px),
      height_(height_px) {}

void Canvas::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Colour colour,
                  double thickness) {
  cv::line(page_, fine(a), fine(b), bgr(colour), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::dashed(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Colour colour,
                    double thickness) {
  constexpr double kDash = 9.0;
  constexpr double kPeriod = 15.0;
  const double length = (b - a).norm();
  for (double s = 0.0; s < length; s += kPeriod) {
    const double end = std::min(length, s + kDash);
    line(a + (b - a) * (s / length), a + (b - a) * (end / length), colour, thickness);
  }
}

void Canvas::path(const std::vector<Eigen::Vector2d>& points, Colour colour, double thickness) {
  std::vector<cv::Point> fine_points;
  for (const Eigen::Vector2d& point : points) {
    const cv::Point next = fine(point);
    if (fine_points.empty() || next != fine_points.back()) fine_points.push_back(next);
  }
  if (fine_points.size() < 2) return;
  cv::polylines(page_, fine_points, false, bgr(colour), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius, Colour colour) {
  const int r = static_cast<int>(radius * kOversampling * (1 << kShift));
  cv::circle(page_, fine(centre), r, bgr(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::ring(const Eigen::Vector2d& centre, double radius, Colour colour, double thickness) {
  const int r = static_cast<int>(radius * kOversampling * (1 << kShift));
  cv::circle(page_, fine(centre), r, bgr(colour), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::ellipse(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance,
                     double sigmas, Colour colour, double thickness) {
  if (!covariance.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  std::vector<Eigen::Vector2d> outline;
  constexpr int kCorners = 48;
  const Eigen::Vector2d radii = sigmas * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  for (int i = 0; i <= kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    const Eigen::Vector2d unit(std::cos(angle), std::sin(angle));
    outline.push_back(centre + axes.eigenvectors() * radii.cwiseProduct(unit));
  }
  path(outline, colour, thickness);
}

double Canvas::text_width(const std::string& text, double size, bool bold) const {
  int below = 0;
  const cv::Size extent =
      cv::getTextSize(text, kFont, font_scale(size), font_thickness(size, bold), &below);
  return static_cast<double>(extent.width) / kOversampling;
}

void Canvas::put(const Eigen::Vector2d& at, const std::string& text, double size, Colour colour,
                 Anchor anchor, bool bold, int rim) {
  const double width = text_width(text, size, bold);
  const double shift = anchor == Anchor::kLeft ? 0.0 : anchor == Anchor::kRight ? width : width / 2;
  cv::putText(page_, text, whole(at - Eigen::Vector2d(shift, 0.0)), kFont, font_scale(size),
              bgr(colour), font_thickness(size, bold) + rim, cv::LINE_AA);
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& text, double size, Colour colour,
                  Anchor anchor, bool bold) {
  put(at, text, size, colour, anchor, bold, 0);
}

void Canvas::halo(const Eigen::Vector2d& at, const std::string& text, double size, Anchor anchor,
                  bool bold) {
  constexpr Colour kWhite{255, 255, 255};
  put(at, text, size, kWhite, anchor, bold, 5 * kOversampling);
}

void Canvas::vertical_text(const Eigen::Vector2d& at, const std::string& text, double size,
                           Colour colour) {
  const int length = static_cast<int>(std::ceil(text_width(text, size))) + 4;
  const int tall = static_cast<int>(std::ceil(size * 2.0));
  Canvas strip(length, tall);
  strip.text({2.0, size * 1.4}, text, size, colour);
  cv::Mat turned;
  cv::rotate(strip.page_, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Point corner = whole(at - Eigen::Vector2d(size * 1.4, length));
  const cv::Rect place(corner, turned.size());
  if ((place & cv::Rect({}, page_.size())) != place) return;
  cv::Mat target = page_(place);
  cv::min(target, turned, target);
}

void Canvas::image(const Eigen::Vector2d& corner, const cv::Mat& grey, double width) {
  const double scale = width * kOversampling / grey.cols;
  const cv::Size size(static_cast<int>(std::round(grey.cols * scale)),
                      static_cast<int>(std::round(grey.rows * scale)));
  const cv::Rect place = cv::Rect(whole(corner), size) & cv::Rect({}, page_.size());
  if (place.size() != size) return;
  cv::Mat resized;
  cv::resize(grey, resized, size, 0.0, 0.0, cv::INTER_AREA);
  cv::cvtColor(resized, page_(place), cv::COLOR_GRAY2BGR);
}

Status write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  std::vector<std::uint8_t> bytes;
  bool encoded = false;
  try {
    encoded = cv::imencode(path.extension().string(), picture, bytes);
  } catch (const cv::Exception&) {
    encoded = false;
  }
  if (!encoded) return Error{path.string() + ": no picture of this format can be written"};
  return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Status Canvas::save(const std::filesystem::path& path) const {
  cv::Mat picture;
  cv::resize(page_, picture, {width_, height_}, 0.0, 0.0, cv::INTER_AREA);
  return write_picture(path, picture);
}

}  // namespace zenith::tools
