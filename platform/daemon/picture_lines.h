#pragma once
// A picture (slam/picture.h) as lines of telemetry: its corners, then the image in strips, which no
// socket is too small for. Grey values as base64: a computer that looks may compress them, the
// robot does not.

#include <array>
#include <string_view>

#include "platform/base/base64.h"
#include "platform/daemon/json_line.h"
#include "slam/picture.h"

namespace zenith {

inline constexpr int kStripRows = 64;
inline constexpr std::size_t kStripBytes = std::size_t{kStripRows} * kRectifiedSize;
static_assert(kRectifiedSize % kStripRows == 0);

using CornersLine = BasicJsonLine<8192>;
using StripLine = BasicJsonLine<base64_size(kStripBytes) + 256>;

// Of each corner [u_px, v_px, kind, predicted u_px, predicted v_px]; kind 0: no landmark, 1: taken
// for one, 2: and the others agree.
void write_corners(CornersLine& line, const Picture& picture);
// The rows from `first_row`, kStripRows of them.
void write_strip(StripLine& line, const Picture& picture, int first_row);

}  // namespace zenith
