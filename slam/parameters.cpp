#include "slam/parameters.h"

#include <array>

namespace zenith {
namespace {

using P = Parameters;

constexpr auto kTable = std::to_array<ParameterInfo>({
    {"rectified_fov_deg", "deg", 60, 150, "field of view of the rectified image", &P::rectified_fov_deg},
    {"particles", "", 1, 1024, "number of particles", &P::particles},
});

}  // namespace

std::span<const ParameterInfo> parameter_table() { return kTable; }

}  // namespace zenith
