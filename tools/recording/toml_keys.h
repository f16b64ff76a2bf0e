#pragma once
// Reading keys of TOML files so that every mistake is told with its line, all at once.

#include <string>
#include <vector>

#include <toml++/toml.h>

#include "tools/recording/problems.h"

namespace zenith::tools {

int line_of(const toml::node& node);

// Tells keys of `table` that are not among the known ones. `prefix` is the table's name with a dot.
void check_keys(const toml::table& table, const std::string& prefix,
                const std::vector<std::string>& known, Problems& problems);

// The same for a section of the file; one that is missing is not told here, for its keys will be.
void check_section(const toml::table& file, const char* section,
                   const std::vector<std::string>& known, Problems& problems);

// A key that must be there. `value` stays as it is when it is not.
void read_text(const toml::table& file, const char* section, const char* key, std::string& value,
               Problems& problems);

}  // namespace zenith::tools
