#include "tools/recording/toml_keys.h"

#include <algorithm>

#include "tools/overrides.h"

namespace zenith::tools {

int line_of(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

void check_keys(const toml::table& table, const std::string& prefix,
                const std::vector<std::string>& known, Problems& problems) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = nearest_words(name, known);
    problems.add(line_of(node),
                 "unknown key " + prefix + name +
                     (near.empty() ? "" : "; did you mean " + prefix + near[0] + "?"));
  }
}

void check_section(const toml::table& file, const char* section,
                   const std::vector<std::string>& known, Problems& problems) {
  const auto node = file[section];
  if (!node) return;  // its keys are told as missing
  if (const toml::table* table = node.as_table()) {
    check_keys(*table, std::string(section) + ".", known, problems);
  } else {
    problems.add(line_of(*node.node()), std::string(section) + " is no section");
  }
}

void read_text(const toml::table& file, const char* section, const char* key, std::string& value,
               Problems& problems) {
  const std::string name = std::string(section) + "." + key;
  const auto node = file[section][key];
  if (!node) return problems.add(0, "missing key " + name);
  const auto text = node.value<std::string>();
  if (!text) return problems.add(line_of(*node.node()), name + " is no text");
  value = *text;
}

}  // namespace zenith::tools
