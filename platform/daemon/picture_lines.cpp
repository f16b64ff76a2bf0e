#include "platform/daemon/picture_lines.h"

#include <cmath>
#include <span>

namespace zenith {
namespace {

constexpr std::size_t kNumbers = 5;

double tenths(float value) {
  return std::round(static_cast<double>(value) * 10.0) / 10.0;
}

}  // namespace

void write_corners(CornersLine& line, const Picture& picture) {
  FixedVector<double, kNumbers * kMaxCorners> rows;
  for (const SeenCorner& c : picture.corners) {
    const int kind = c.landmark == 0 ? 0 : c.inlier ? 2 : 1;
    rows.push_back(tenths(c.u_px));
    rows.push_back(tenths(c.v_px));
    rows.push_back(kind);
    rows.push_back(tenths(c.predicted_u_px));
    rows.push_back(tenths(c.predicted_v_px));
  }
  line.text("type", "picture")
      .count("stamp_ns", static_cast<unsigned long long>(picture.stamp.ns))
      .number("width", kRectifiedSize)
      .number("height", kRectifiedSize)
      .flag("used", picture.used)
      .numbers("corners", rows.span());
}

void write_strip(StripLine& line, const Picture& picture, int first_row) {
  const auto first = static_cast<std::size_t>(first_row) * kRectifiedSize;
  const auto bytes = std::span<const std::uint8_t>(picture.image).subspan(first, kStripBytes);
  std::array<char, base64_size(kStripBytes)> text;
  write_base64(bytes, text.data());
  line.text("type", "strip")
      .count("stamp_ns", static_cast<unsigned long long>(picture.stamp.ns))
      .number("first_row", first_row)
      .text("grey", {text.data(), text.size()});
}

}  // namespace zenith
