#pragma once
// A picture by which a person sees whether a lens is right: a flat ceiling of square tiles as the
// camera shows it, with rings of equal angle from the optical axis; beside it the same, rectified,
// where straight lines must be straight. With an image of the camera both stand upon it.

#include <filesystem>

#include "platform/base/result.h"
#include "slam/image/lens.h"

namespace zenith::tools {

// `image` may be empty; else it must be as large as the lens says.
Status draw_lens(const Lens& lens, const std::filesystem::path& image,
                 const std::filesystem::path& path);

}  // namespace zenith::tools
