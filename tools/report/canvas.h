#pragma once
// A white page to draw on, in pixels of the finished picture. Drawn at twice the size and reduced,
// so that lines and letters come out smooth.

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "platform/base/result.h"
#include "tools/report/colour.h"

namespace zenith::tools {

// As a whole file, in the format that its ending names.
Status write_picture(const std::filesystem::path& path, const cv::Mat& picture);

enum class Anchor { kLeft, kCentre, kRight };

class Canvas {
 public:
  Canvas(int width_px, int height_px);

  int width() const { return width_; }
  int height() const { return height_; }

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Colour colour, double thickness);
  void dashed(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Colour colour, double thickness);
  void path(const std::vector<Eigen::Vector2d>& points, Colour colour, double thickness);
  void disc(const Eigen::Vector2d& centre, double radius, Colour colour);
  void ring(const Eigen::Vector2d& centre, double radius, Colour colour, double thickness);
  // `covariance` in square pixels; drawn at so many sigma.
  void ellipse(const Eigen::Vector2d& centre, const Eigen::Matrix2d& covariance, double sigmas,
               Colour colour, double thickness);
  // `at` lies on the base line; `size` is the height of a capital letter.
  void text(const Eigen::Vector2d& at, const std::string& text, double size, Colour colour,
            Anchor anchor = Anchor::kLeft, bool bold = false);
  // A white rim for the text that is written over it.
  void halo(const Eigen::Vector2d& at, const std::string& text, double size,
            Anchor anchor = Anchor::kLeft, bool bold = false);
  // `at` is the lower end of a text that runs upwards.
  void vertical_text(const Eigen::Vector2d& at, const std::string& text, double size,
                     Colour colour);
  // A grey image, its upper left corner at `corner`, so wide on the page.
  void image(const Eigen::Vector2d& corner, const cv::Mat& grey, double width);
  double text_width(const std::string& text, double size, bool bold = false) const;

  Status save(const std::filesystem::path& path) const;

 private:
  void put(const Eigen::Vector2d& at, const std::string& text, double size, Colour colour,
           Anchor anchor, bool bold, int rim);

  cv::Mat page_;
  int width_;
  int height_;
};

}  // namespace zenith::tools
