// Looks of photographed ceilings, each seen a second time through a simulated camera.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <opencv2/imgproc.hpp>

#include "platform/base/memory_block.h"
#include "platform/base/random.h"
#include "slam/image/corners.h"
#include "tools/descriptors/looks.h"
#include "tools/picture_file.h"

namespace zenith::tools {
namespace {

constexpr int kTilesAcross = 3;
constexpr int kTilesDown = 2;
constexpr int kRounds = 3;  // times that each tile is looked at again
constexpr double kSamePlace_px = 2.0;
constexpr double kNoise_grey = 3.0;

struct DescribedCorner {
  Eigen::Vector2d at_px;
  float orientation_rad = 0.0F;
  Patch patch;
};

class Describer {
 public:
  Describer() : memory_(needed()) {
    Arena arena(memory_.span());
    detector_.layout(arena);
  }

  std::vector<DescribedCorner> describe(const cv::Mat& tile) {
    const ImageView image = {tile.data, tile.cols, tile.rows,
                             static_cast<std::ptrdiff_t>(tile.step)};
    CornerSettings settings;
    settings.min_eigenvalue = 5.0;
    detector_.detect(image, settings, corners_);
    std::vector<DescribedCorner> out;
    for (const Corner& c : corners_) {
      const float direction = patch_orientation(image, c.u_px, c.v_px);
      const Patch patch = sample_patch(image, c.u_px, c.v_px, direction);
      if (patch.inverse_norm > 0.0F) out.push_back({{c.u_px, c.v_px}, direction, patch});
    }
    return out;
  }

 private:
  static std::size_t needed() {
    Arena arena;
    CornerDetector detector;
    detector.layout(arena);
    return arena.used();
  }
  MemoryBlock memory_;
  CornerDetector detector_;
  Corners corners_;
};

// How a tile of the photograph is seen again.
struct SecondView {
  cv::Matx23d photo_to_view;
  double turn_rad = 0.0;
  double gain = 1.0;
  double offset = 0.0;

  SecondView(const cv::Point2d& centre, Random& random)
      : turn_rad(random.uniform(-std::numbers::pi, std::numbers::pi)),
        gain(random.uniform(0.7, 1.3)),
        offset(random.uniform(-20.0, 20.0)) {
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    const double middle = 0.5 * (kRectifiedSize - 1);
    const double u = middle + random.uniform(-0.5, 0.5);
    const double v = middle + random.uniform(-0.5, 0.5);
    photo_to_view = cv::Matx23d(c, -s, u - c * centre.x + s * centre.y,  //
                                s, c, v - s * centre.x - c * centre.y);
  }
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const {
    const cv::Matx23d& m = photo_to_view;
    return {m(0, 0) * p.x() + m(0, 1) * p.y() + m(0, 2),
            m(1, 0) * p.x() + m(1, 1) * p.y() + m(1, 2)};
  }
  cv::Mat render(const cv::Mat& photo, Random& random) const {
    cv::Mat view;
    cv::warpAffine(photo, view, photo_to_view, {kRectifiedSize, kRectifiedSize}, cv::INTER_CUBIC,
                   cv::BORDER_REFLECT);
    for (int v = 0; v < view.rows; ++v) {
      for (int u = 0; u < view.cols; ++u) {
        auto& value = view.at<std::uint8_t>(v, u);
        const double grey = gain * static_cast<double>(value) + offset;
        value = cv::saturate_cast<std::uint8_t>(grey + kNoise_grey * random.normal());
      }
    }
    return view;
  }
};

class PhotoLooker {
 public:
  PhotoLooker(LookSequence& out, std::uint64_t seed) : out_(out), random_(seed, 7) {}

  void look_at(const cv::Mat& photo) {
    for (int row = 0; row < kTilesDown; ++row) {
      for (int column = 0; column < kTilesAcross; ++column) {
        const cv::Rect tile(column * kRectifiedSize, row * kRectifiedSize, kRectifiedSize,
                            kRectifiedSize);
        look_at_tile(photo, tile);
      }
    }
  }

 private:
  void look_at_tile(const cv::Mat& photo, const cv::Rect& tile) {
    const std::vector<DescribedCorner> first = describer_.describe(photo(tile).clone());
    const std::size_t base = out_.places_m.size();
    ++tile_;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const Eigen::Vector2d at = first[i].at_px + Eigen::Vector2d(tile.x, tile.y);
      out_.places_m.emplace_back(at.x(), at.y(), 1000.0 * tile_);
      add(first[i], base + i, 0, 0.0);
    }
    const cv::Point2d centre(tile.x + 0.5 * (kRectifiedSize - 1),
                             tile.y + 0.5 * (kRectifiedSize - 1));
    for (int round = 0; round < kRounds; ++round) {
      const SecondView view(centre, random_);
      for (const DescribedCorner& c : describer_.describe(view.render(photo, random_))) {
        const auto nearest = nearest_place(base, view, c.at_px);
        if (nearest) add(c, *nearest, round + 1, view.turn_rad);
      }
    }
  }

  std::optional<std::size_t> nearest_place(std::size_t base, const SecondView& view,
                                           const Eigen::Vector2d& at_px) const {
    std::optional<std::size_t> best;
    double best_px = kSamePlace_px;
    for (std::size_t i = base; i < out_.places_m.size(); ++i) {
      const double distance = (view * out_.places_m[i].head<2>() - at_px).norm();
      if (distance >= best_px) continue;
      best_px = distance;
      best = i;
    }
    return best;
  }

  void add(const DescribedCorner& c, std::size_t place, int round, double turn_rad) {
    Look look;
    look.landmark = static_cast<int>(place);
    look.robot = round == 0 ? 0 : 1;
    look.frame = tile_ * (kRounds + 1) + round;
    look.direction_rad =
        static_cast<float>(wrap_angle(static_cast<double>(c.orientation_rad) - turn_rad));
    look.patch = c.patch;
    out_.looks.push_back(look);
  }

  LookSequence& out_;
  Random random_;
  Describer describer_;
  int tile_ = 0;
};

}  // namespace

Result<LookSequence> photo_looks(const std::filesystem::path& folder, std::uint64_t seed) {
  if (!std::filesystem::is_directory(folder)) return Error{"there is no folder " + folder.string()};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".jpg" || extension == ".png") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  LookSequence out;
  out.name = "photographs";
  out.robots = 2;
  out.synthetic = true;
  PhotoLooker looker(out, seed);
  for (const std::filesystem::path& file : files) {
    const auto photo = read_grey_picture(file);
    if (!photo) return Error{"the photograph " + file.string() + ": " + photo.error().message};
    // The same size for all: 3 x 2 tiles as large as the rectified image.
    cv::Mat scaled;
    cv::resize(*photo, scaled, {kTilesAcross * kRectifiedSize, kTilesDown * kRectifiedSize}, 0, 0,
               cv::INTER_AREA);
    looker.look_at(scaled);
  }
  if (out.looks.empty()) return Error{"no photographs (.jpg, .png) in " + folder.string()};
  return out;
}

}  // namespace zenith::tools
