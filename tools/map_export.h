#pragma once
// A stored map for other programs and for eyes. Coordinates are the map's own, in metres.

#include <filesystem>
#include <string>

#include "platform/base/result.h"
#include "platform/storage/map_file.h"

namespace zenith::tools {

// Points with their standard deviations; CloudCompare, MeshLab and Open3D read them.
std::string map_as_ply(const storage::StoredMap& map);
// Columns as landmarks.csv of a replay.
std::string map_as_csv(const storage::StoredMap& map);
// Seen from below, with a scale.
Status draw_stored_map(const storage::StoredMap& map, const std::filesystem::path& file);

// By the ending of `file`: .ply, .csv or .png.
Status export_map(const storage::StoredMap& map, const std::filesystem::path& file);

}  // namespace zenith::tools
