#pragma once
// The colours of pictures and of what viewers are sent. Plain numbers: no drawing library.

#include <array>
#include <cstddef>

namespace zenith::tools {

// 0 to 255 each.
struct Colour {
  int red = 0;
  int green = 0;
  int blue = 0;
};

inline constexpr Colour kInk{33, 37, 41};
inline constexpr Colour kGrey{140, 146, 152};
inline constexpr Colour kPale{232, 235, 238};
inline constexpr Colour kMagenta{214, 20, 160};

// A colour for each robot, told apart by most colour-blind people too. Those of the page stand in
// web/main.js.
inline Colour robot_colour(std::size_t index) {
  constexpr std::array<Colour, 9> kColours = {{
      {0, 98, 178},    // blue
      {222, 93, 0},    // orange
      {0, 138, 92},    // green
      {120, 70, 180},  // violet
      {150, 110, 0},   // ochre
      {0, 150, 190},   // cyan
      {180, 30, 60},   // red
      {90, 90, 90},    // grey
      {60, 120, 30},   // moss
  }};
  return kColours[index % kColours.size()];
}

}  // namespace zenith::tools
