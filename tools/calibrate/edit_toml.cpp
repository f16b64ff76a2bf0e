#include "tools/calibrate/edit_toml.h"

#include <optional>
#include <sstream>
#include <utility>

#include "platform/config/setting.h"
#include "platform/config/toml_text.h"
#include "tools/atomic_output.h"

namespace zenith::tools {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

// "[a.b]  # why" -> "a.b"; none for other lines.
std::optional<std::string> section_of(const std::string& line) {
  const std::string plain = trimmed(line);
  if (plain.size() < 2 || plain[0] != '[' || plain[1] == '[') return std::nullopt;
  const std::size_t end = plain.find(']');
  return end == std::string::npos ? std::nullopt : std::optional(trimmed(plain.substr(1, end - 1)));
}

bool is_key(const std::string& line, const std::string& key) {
  const std::size_t equals = line.find('=');
  return equals != std::string::npos && trimmed(line.substr(0, equals)) == key;
}

// Where a comment begins behind a value that is a number or a text without '#'.
std::string with_value(const std::string& line, const std::string& value) {
  const std::size_t equals = line.find('=');
  const std::size_t comment = line.find('#', equals);
  std::string out = line.substr(0, equals) + "= " + value;
  if (comment != std::string::npos) out += "   " + line.substr(comment);
  return out;
}

void set_value(std::vector<std::string>& lines, const std::string& full_key,
               const std::string& value) {
  const auto [section, key] = split_key(full_key);
  std::string current;
  std::optional<std::size_t> last;  // line of the section with content
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (const auto named = section_of(lines[i])) {
      current = *named;
      if (current == section) last = i;
      continue;
    }
    if (current != section) continue;
    if (is_key(lines[i], key)) {
      lines[i] = with_value(lines[i], value);
      return;
    }
    const std::string plain = trimmed(lines[i]);
    if (!plain.empty() && plain[0] != '#') last = i;
  }
  if (!last) {
    if (!lines.empty()) lines.emplace_back();
    lines.push_back("[" + section + "]");
    last = lines.size() - 1;
  }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(*last + 1), key + " = " + value);
}

bool is_same(const toml::node_view<const toml::node>& a,
             const toml::node_view<const toml::node>& b) {
  if (a.is_array() && b.is_array()) return *a.as_array() == *b.as_array();
  if (a.is_string() && b.is_string()) return *a.as_string() == *b.as_string();
  if (a.is_boolean() && b.is_boolean()) return *a.as_boolean() == *b.as_boolean();
  return a.value<double>().has_value() && a.value<double>() == b.value<double>();
}

Status check_values(const std::filesystem::path& path, const std::string& text,
                    const TomlValues& values) {
  const toml::parse_result parsed = parse_toml(text);
  if (!parsed) return toml_error(path, parsed.error());
  for (const auto& [key, value] : values) {
    const auto wanted = toml::parse("v = " + value);
    const auto found = std::as_const(parsed.table()).at_path(key);
    if (wanted && found && is_same(found, std::as_const(wanted.table())["v"])) continue;
    return Error{path.string() + ": " + key + " = " + value +
                 " cannot be written without changing the file's layout; it is written in a way "
                 "that only a person can edit, so set it by hand"};
  }
  return {};
}

}  // namespace

std::string edited_toml(const std::string& text, const TomlValues& values) {
  std::vector<std::string> lines = lines_of(text);
  for (const auto& [key, value] : values) set_value(lines, key, value);
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

bool has_toml_key(const std::filesystem::path& path, const std::string& key) {
  const auto text = read_toml(path);
  if (!text) return false;
  const toml::parse_result parsed = parse_toml(*text);
  return parsed && parsed.table().at_path(key);
}

Status edit_toml_file(const std::filesystem::path& path, const TomlValues& values) {
  std::string text;
  std::error_code code;
  if (std::filesystem::exists(path, code)) {
    auto content = read_toml(path);
    if (!content) return content.error();
    text = std::move(*content);
    const toml::parse_result parsed = parse_toml(text);
    if (!parsed) return toml_error(path, parsed.error());
  }
  const std::string edited = edited_toml(text, values);
  if (const Status checked = check_values(path, edited, values); !checked) return checked;
  // Behind a link stands the file that is meant.
  const std::filesystem::path real = std::filesystem::weakly_canonical(path, code);
  const std::filesystem::path place = code ? path : real;
  const auto before = std::filesystem::status(place, code);
  const Status written = write_file(place, edited);
  if (written && std::filesystem::exists(before)) {
    std::filesystem::permissions(place, before.permissions(), code);
  }
  return written;
}

}  // namespace zenith::tools
