#pragma once
// A drawing surface in metres for reflectances and radiances. Every shape is anti-aliased by its
// coverage of the texel, so that its edge lies where it was drawn and not where a texel begins.

#include <vector>

#include "platform/base/random.h"
#include "sim/texture.h"
#include "sim/world_file.h"

namespace zenith::sim {

// How a shape changes what lies under it: towards `value` by `alpha`, or, when `multiply` is set,
// times `value`.
struct Ink {
  float value = 0.0F;
  float alpha = 1.0F;
  bool multiply = false;
};

inline Ink paint(double value, double alpha = 1.0) {
  return {static_cast<float>(value), static_cast<float>(alpha), false};
}
inline Ink shade(double factor) {
  return {static_cast<float>(factor), 1.0F, true};
}

class Canvas {
 public:
  // The origin is the surface's corner (a0, b0); width along a, height along b.
  Canvas(double width_m, double height_m, double texel_m, double value);

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }
  double texel_m() const { return texel_m_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  float* row(int j) { return values_.data() + static_cast<std::size_t>(j) * columns_; }

  void rect(const Rect& r, const Ink& ink);
  // The outline of a rectangle, `line_m` wide, inside its edge.
  void frame(const Rect& r, double line_m, const Ink& ink);
  void disc(double x, double y, double radius_m, const Ink& ink);
  void ring(double x, double y, double radius_m, double line_m, const Ink& ink);
  void line(double x0, double y0, double x1, double y1, double line_m, const Ink& ink);
  // An irregular spot: a disc whose radius wobbles, with a soft edge.
  void blob(double x, double y, double radius_m, double softness_m, const Ink& ink, Random& random);
  // Times 1 + amplitude * smooth noise with features of about `size_m`.
  void mottle(double size_m, double amplitude, Random& random);
  // Each texel times 1 - depth * u^power, u uniform: fine pores.
  void pores(double depth, Random& random);

  Texture texture() const {
    return Texture(columns_, rows_, static_cast<float>(texel_m_), values_);
  }

 private:
  // Calls coverage(x, y) with the texels' centres (metres) in the given bounds.
  template <typename Coverage>
  void cover(double x0, double y0, double x1, double y1, const Ink& ink, Coverage coverage);

  double width_m_;
  double height_m_;
  double texel_m_;
  int columns_;
  int rows_;
  std::vector<float> values_;
};

}  // namespace zenith::sim
