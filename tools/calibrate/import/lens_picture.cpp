#include "tools/calibrate/import/lens_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "slam/image/lens_extent.h"
#include "tools/doctor/formatted.h"
#include "tools/picture_file.h"
#include "tools/report/canvas.h"

namespace zenith::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPanel_px = 620.0;
constexpr double kMargin_px = 32.0;
constexpr double kTitle_px = 84.0;
constexpr int kTiles = 8;  // to each side of the axis
constexpr double kMostRectified_rad = 65.0 * kPi / 180.0;
constexpr Colour kLines{0, 114, 178};
constexpr Colour kRings{213, 94, 0};

// The camera's image on the page, or the rectified one: pixels of rays, and where they are drawn.
struct Panel {
  Eigen::Vector2d corner;
  double width_px;  // of the image that is shown
  double height_px;

  double scale() const { return kPanel_px / width_px; }
  Eigen::Vector2d at(const Eigen::Vector2d& uv) const {
    return corner + scale() * (uv + Eigen::Vector2d(0.5, 0.5));
  }
  bool holds(const Eigen::Vector2d& uv) const {
    return uv.x() >= -0.5 && uv.y() >= -0.5 && uv.x() <= width_px - 0.5 &&
           uv.y() <= height_px - 0.5;
  }
};

// The rectified view: a pinhole without distortion.
struct Rectified {
  double focal_px;
  Eigen::Vector2d centre;

  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const {
    if (ray.z() < 0.05) return std::nullopt;
    return centre + focal_px / ray.z() * ray.head<2>();
  }
  Eigen::Vector3d ray_of(double u, double v) const {
    return {(u - centre.x()) / focal_px, (v - centre.y()) / focal_px, 1.0};
  }
};

template <typename Projection, typename RayOf>
void draw_curve(Canvas& canvas, const Panel& panel, const Projection& projection, RayOf ray_of,
                int steps, Colour colour) {
  std::vector<Eigen::Vector2d> piece;
  for (int i = 0; i <= steps; ++i) {
    const auto uv = projection.project(ray_of(static_cast<double>(i) / steps));
    if (uv && panel.holds(*uv)) {
      piece.push_back(panel.at(*uv));
      continue;
    }
    canvas.path(piece, colour, 1.3);
    piece.clear();
  }
  canvas.path(piece, colour, 1.3);
}

// Of the ceiling's height above the camera, so that a lens shows some of them; half of it for wide
// lenses, whose ceiling then ends at 76 degrees from the axis.
double tile_of(double widest_rad) {
  for (const double tile : {0.02, 0.05, 0.1, 0.2}) {
    if (std::tan(std::min(widest_rad, 1.5)) < 5.0 * tile) return tile;
  }
  return 0.5;
}

template <typename Projection>
void draw_ceiling(Canvas& canvas, const Panel& panel, const Projection& projection, double tile) {
  const double end = kTiles * tile;
  for (int line = -kTiles; line <= kTiles; ++line) {
    const double at = line * tile;
    const auto along = [at, end](double s) {
      return Eigen::Vector3d(at, end * (2.0 * s - 1.0), 1.0);
    };
    const auto across = [at, end](double s) {
      return Eigen::Vector3d(end * (2.0 * s - 1.0), at, 1.0);
    };
    draw_curve(canvas, panel, projection, along, 800, kLines);
    draw_curve(canvas, panel, projection, across, 800, kLines);
  }
}

template <typename Projection>
void draw_rings(Canvas& canvas, const Panel& panel, const Projection& projection,
                double widest_rad) {
  const int step_deg = widest_rad > 0.7 ? 15 : 5;
  for (int ring_deg = step_deg; ring_deg < widest_rad * 180.0 / kPi + 1.0; ring_deg += step_deg) {
    const double theta = ring_deg * kPi / 180.0;
    const auto ray = [theta](double s) {
      const double azimuth = 2.0 * kPi * s;
      return Eigen::Vector3d(std::sin(theta) * std::cos(azimuth),
                             std::sin(theta) * std::sin(azimuth), std::cos(theta));
    };
    draw_curve(canvas, panel, projection, ray, 360, kRings);
    const auto label = projection.project(ray(0.12));
    if (!label || !panel.holds(*label)) continue;
    const std::string text = std::to_string(ring_deg);
    canvas.halo(panel.at(*label), text, 10.0);
    canvas.text(panel.at(*label), text, 10.0, kRings);
  }
}

void draw_frame(Canvas& canvas, const Panel& panel, const char* title) {
  const double w = panel.width_px;
  const double h = panel.height_px;
  const Eigen::Vector2d half(-0.5, -0.5);
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(w, 0), Eigen::Vector2d(w, h), Eigen::Vector2d(0, h),
        Eigen::Vector2d(0, 0)}) {
    corners.push_back(panel.at(corner + half));
  }
  canvas.path(corners, kInk, 1.2);
  canvas.text(panel.corner + Eigen::Vector2d(0.0, -10.0), title, 12.0, kInk);
}

// Halved until it is no larger than it is drawn.
cv::Mat for_page(const cv::Mat& grey) {
  cv::Mat out = grey;
  while (out.cols > 4 * static_cast<int>(kPanel_px))
    cv::resize(out, out, {}, 0.5, 0.5, cv::INTER_AREA);
  return out;
}

cv::Mat rectify(const cv::Mat& grey, const LensProjection& projection, const Rectified& view,
                const Panel& panel) {
  const cv::Size size(static_cast<int>(panel.width_px), static_cast<int>(panel.height_px));
  cv::Mat u(size, CV_32F);
  cv::Mat v(size, CV_32F);
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const auto uv = projection.project(view.ray_of(column, row));
      u.at<float>(row, column) = uv ? static_cast<float>(uv->x()) : -1e4F;
      v.at<float>(row, column) = uv ? static_cast<float>(uv->y()) : -1e4F;
    }
  }
  cv::Mat out;
  cv::remap(grey, out, u, v, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(255));
  return out;
}

Result<cv::Mat> read_image(const Lens& lens, const std::filesystem::path& path) {
  auto grey = read_grey_picture(path);
  if (!grey) return Error{path.string() + ": " + grey.error().message};
  if (grey->cols != lens.width_px || grey->rows != lens.height_px) {
    return Error{path.string() +
                 formatted(": the image has %d x %d pixels, the lens's have %d x %d", grey->cols,
                           grey->rows, lens.width_px, lens.height_px)};
  }
  return grey;
}

}  // namespace

Status draw_lens(const Lens& lens, const std::filesystem::path& image,
                 const std::filesystem::path& path) {
  cv::Mat grey;
  if (!image.empty()) {
    auto read = read_image(lens, image);
    if (!read) return read.error();
    grey = *read;
  }
  const LensProjection projection(lens);
  const double widest_rad = lens_extent(projection).widest_rad;
  const double tile = tile_of(widest_rad);
  const double height_px = kPanel_px * lens.height_px / lens.width_px;
  const Panel seen{{kMargin_px, kTitle_px},
                   static_cast<double>(lens.width_px),
                   static_cast<double>(lens.height_px)};
  const Panel flat{{2.0 * kMargin_px + kPanel_px, kTitle_px}, kPanel_px, height_px};
  const double half = 0.5 * std::hypot(kPanel_px, height_px);
  const Rectified view{half / std::tan(std::min(widest_rad, kMostRectified_rad)),
                       {0.5 * kPanel_px - 0.5, 0.5 * height_px - 0.5}};
  Canvas canvas(static_cast<int>(2.0 * kPanel_px + 3.0 * kMargin_px),
                static_cast<int>(kTitle_px + height_px + 64.0));
  canvas.text({kMargin_px, 40.0}, "The lens: a ceiling of square tiles, and degrees from the axis",
              18.0, kInk, Anchor::kLeft, true);
  if (!grey.empty()) {
    canvas.image(seen.corner, for_page(grey), kPanel_px);
    canvas.image(flat.corner, rectify(grey, projection, view, flat), kPanel_px);
  }
  draw_ceiling(canvas, seen, projection, tile);
  draw_rings(canvas, seen, projection, widest_rad);
  draw_frame(canvas, seen, "as the camera shows it");
  draw_ceiling(canvas, flat, view, tile);
  draw_rings(canvas, flat, view, std::min(widest_rad, kMostRectified_rad));
  draw_frame(canvas, flat, "rectified: what is straight in the world must be straight here");
  canvas.text({kMargin_px, kTitle_px + height_px + 36.0},
              "The lens is right when the lines on the left bend as straight edges in the camera's "
              "images do.",
              12.0, kInk);
  return canvas.save(path);
}

}  // namespace zenith::tools
