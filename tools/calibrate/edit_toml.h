#pragma once
// Changes single values of a TOML file and leaves all else as it is: comments, order, other keys.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "platform/base/result.h"

namespace zenith::tools {

// "lens.fu_px" and its value as TOML writes it.
using TomlValues = std::vector<std::pair<std::string, std::string>>;

// `text` with these values. A key that is not there is added behind the last one of its section, a
// section that is not there at the end.
std::string edited_toml(const std::string& text, const TomlValues& values);

// Whether the file has the key; not one that does not exist or is not TOML.
bool has_toml_key(const std::filesystem::path& path, const std::string& key);

// The same of a file, atomically. One that does not exist is made. The result is read back before
// it takes the old one's place: an error, and the file stays as it was, when it is not as meant.
Status edit_toml_file(const std::filesystem::path& path, const TomlValues& values);

}  // namespace zenith::tools
