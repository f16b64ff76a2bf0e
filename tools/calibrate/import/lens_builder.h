#pragma once
// From a format's numbers to a Lens: which word of which program means which model, how many
// coefficients it has, and what of them no model here has.

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/calibrate/import/foreign_lens.h"
#include "tools/calibrate/import/tree.h"

namespace zenith::tools {

// The part of a sensor that its images show; a width of 0: all of it.
struct SensorWindow {
  double x_px = 0.0;
  double y_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;
};

// Reads values of a map and fills a ForeignLens. The first problem becomes its `refused`; all calls
// after it do no harm.
class LensBuilder {
 public:
  LensBuilder(std::string format, std::string camera, ForeignModel wanted);

  void refuse(const std::string& why) {
    if (out_.refused.empty()) out_.refused = why;
  }
  void note(const std::string& what) { out_.notes.push_back(what); }
  bool refused() const { return !out_.refused.empty(); }
  ForeignModel wanted() const { return wanted_; }

  // A value of the map under one of these plain keys; refused when it is missing or no number.
  double number(const Node& map, std::initializer_list<std::string_view> names);
  // `otherwise` when it is missing.
  double number_or(const Node& map, std::initializer_list<std::string_view> names,
                   double otherwise);
  std::vector<double> numbers(const Node& node, const std::string& what);
  static std::string text(const Node& map, std::initializer_list<std::string_view> names);

  // 0 and less, or no number: the size stays unknown.
  void set_size(double width, double height);
  // image_width and image_height, image_size: [w, h], resolution: [w, h] and the like, of the map.
  void size_from(const Node& map);
  // fx, fy, cx, cy in this order.
  void set_pinhole(double fx, double fy, double cx, double cy);
  // A 3 x 3 matrix, row by row; of a 3 x 4 one the left part.
  void set_matrix(const std::vector<double>& matrix);

  // The images are this part of what the numbers so far describe, and binned.
  void apply_window(const SensorWindow& window, double binning_x, double binning_y);

  // Distortion by the file's word for it, "" when it has none, and its coefficients in OpenCV's
  // order: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tx ty, or k1 k2 k3 k4 of a fisheye.
  void set_distortion(const std::string& word, const std::vector<double>& coefficients);
  void set_omni(double xi, const std::vector<double>& radtan);
  void set_double_sphere(double xi, double alpha);
  void set_eucm(double alpha, double beta);
  void set_fov(double w_rad);
  // OCamCalib's: v = c x + d y + cv and u = e x + y + cu, x downwards.
  void set_scaramuzza(double c, double d, double e, const std::vector<double>& polynomial,
                      const std::vector<double>& inverse);

  void set_model_name(const std::string& name) { out_.model = name; }
  ForeignLens take();

 private:
  void set_radtan(const std::vector<double>& coefficients, bool rational_named);
  void set_equidistant(const std::vector<double>& coefficients);
  void check_polynomials();

  ForeignLens out_;
  ForeignModel wanted_;
};

}  // namespace zenith::tools
