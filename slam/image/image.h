#pragma once
// Images as views of plain memory. A view never owns; it is valid as long as the memory behind it.

#include <cstddef>
#include <cstdint>

namespace zenith {

// 8-bit grey, row-major; `stride` is the distance of two rows in bytes (>= width).
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  const std::uint8_t* row(int v) const { return data + v * stride; }
  std::uint8_t at(int u, int v) const { return row(v)[u]; }
};

struct MutableImageView {
  std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  std::uint8_t* row(int v) const { return data + v * stride; }
  operator ImageView() const { return {data, width, height, stride}; }  // NOLINT
};

}  // namespace zenith
