#pragma once
// The page's files, as the build put them into the program (web/, embed.cmake).

#include <span>
#include <string_view>

namespace zenith::tools {

struct WebAsset {
  std::string_view path;  // "/map.js"
  std::string_view content;
};

std::span<const WebAsset> web_assets();

}  // namespace zenith::tools
