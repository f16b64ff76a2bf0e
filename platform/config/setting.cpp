#include "platform/config/setting.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>
#include <type_traits>

#include "platform/base/printable.h"
#include "platform/config/toml_text.h"
#include "platform/config/words.h"

namespace zenith {
namespace {

constexpr std::size_t kMostQuoted = 80;  // bytes of a file's own words in messages

int line_of(const toml::node& node) {
  return static_cast<int>(node.source().begin.line);
}

// The value itself; returns what is wrong with it, or an empty text.
struct Assign {
  const toml::node& node;

  template <typename T>
  std::string operator()(T* at) const {
    std::optional<T> found;
    const char* problem = "";
    if constexpr (std::is_same_v<T, double>) {
      found = node.value<double>();
      problem = " is no number";
    } else if constexpr (std::is_same_v<T, bool>) {
      found = node.value_exact<bool>();
      problem = " is neither true nor false";
    } else if constexpr (std::is_same_v<T, std::string>) {
      found = node.value_exact<std::string>();
      problem = " is no text";
    } else if constexpr (std::is_same_v<T, int>) {
      found = node.value<int>();
      problem = " is no whole number";
    } else {
      // toml++ knows signed numbers alone: 64 bits of them are enough.
      const auto whole = node.value<std::int64_t>();
      if (whole && *whole >= 0) found = static_cast<T>(*whole);
      if (found && static_cast<std::int64_t>(*found) != *whole) found.reset();
      problem = " is no whole number from 0 on";
    }
    if (!found) return problem;
    *at = std::move(*found);
    return {};
  }

  std::string operator()(const AutoNumber& number) const {
    const auto word = node.value_exact<std::string>();
    if (word && *word == "auto") {
      *number.at = 0.0;
      return {};
    }
    const std::string problem = (*this)(number.at);
    return problem.empty() ? problem : problem + ", nor \"auto\"";
  }

  std::string operator()(std::span<double> at) const {
    const toml::array* list = node.as_array();
    if (list == nullptr) return " is no list of numbers";
    if (list->size() > at.size()) {
      return " holds " + std::to_string(list->size()) + " numbers, expected " +
             std::to_string(at.size()) + " at most";
    }
    std::fill(at.begin(), at.end(), 0.0);
    for (std::size_t i = 0; i < list->size(); ++i) {
      const auto number = list->get(i)->value<double>();
      if (!number || !std::isfinite(*number)) return " holds what is no number";
      at[i] = *number;
    }
    return {};
  }

  std::string operator()(const Choice& choice) const {
    const auto word = node.value_exact<std::string>();
    if (!word) return " is no text";
    const auto found = std::find(choice.words.begin(), choice.words.end(), *word);
    if (found != choice.words.end()) {
      choice.set(static_cast<std::size_t>(found - choice.words.begin()));
      return {};
    }
    std::string known;
    for (const std::string& known_word : choice.words) {
      known += (known.empty() ? "" : ", ") + known_word;
    }
    return " '" + printable_start(*word, kMostQuoted) + "' is unknown; known: " + known;
  }
};

std::optional<double> number_of(const Setting& setting) {
  return std::visit(
      [](const auto& at) -> std::optional<double> {
        using T = std::decay_t<decltype(at)>;
        if constexpr (std::is_same_v<T, Choice> || std::is_same_v<T, bool*> ||
                      std::is_same_v<T, std::string*> || std::is_same_v<T, std::span<double>>) {
          return std::nullopt;
        } else if constexpr (std::is_same_v<T, AutoNumber>) {
          return *at.at;
        } else {
          return static_cast<double>(*at);
        }
      },
      setting.at);
}

bool starts_with(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

// The first names behind `prefix`: keys and sections.
std::vector<std::string> names_under(const std::string& prefix, const Settings& settings) {
  std::vector<std::string> names;
  for (const Setting& setting : settings) {
    if (!starts_with(setting.key, prefix)) continue;
    const std::string rest = setting.key.substr(prefix.size());
    const std::string name = rest.substr(0, rest.find('.'));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string unknown_key(const std::string& prefix, const std::string& name,
                        const Settings& settings) {
  std::string message = "unknown key " + prefix + printable_start(name, kMostQuoted);
  const auto near = nearest_words(name, names_under(prefix, settings));
  if (!near.empty()) return message + "; did you mean " + prefix + near[0] + "?";
  for (const Setting& setting : settings) {  // right, but in the wrong section
    if (split_key(setting.key).second == name) {
      return message + "; did you mean " + setting.key + "?";
    }
  }
  return message;
}

void check_names(const toml::table& table, const std::string& prefix, const Settings& settings,
                 Problems& problems) {
  const auto known = names_under(prefix, settings);
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      problems.add(line_of(node), unknown_key(prefix, name, settings));
      continue;
    }
    const std::string section = prefix + name + ".";
    if (names_under(section, settings).empty()) continue;
    if (const toml::table* sub_table = node.as_table()) {
      check_names(*sub_table, section, settings, problems);
    } else {
      problems.add(line_of(node), prefix + name + " is no section");
    }
  }
}

void read_one(const toml::table& file, const Setting& setting, KeyLines& lines,
              Problems& problems) {
  const auto found = file.at_path(setting.key);
  if (!found) {
    if (setting.required) problems.add(0, "missing key " + setting.key);
    return;
  }
  const int line = line_of(*found.node());
  lines.add(setting.key, line);
  const std::string problem = std::visit(Assign{*found.node()}, setting.at);
  if (!problem.empty()) return problems.add(line, setting.key + problem);
  // "auto" stands beside the range.
  if (std::holds_alternative<AutoNumber>(setting.at) && found.is_string()) return;
  const std::optional<double> number = number_of(setting);
  if (number) problems.check_range(line, setting.key, *number, setting.min, setting.max);
}

struct Write {
  std::string operator()(const double* at) const {
    char text[40];
    return std::string(text, std::to_chars(text, text + sizeof text, *at).ptr);
  }
  std::string operator()(const AutoNumber& number) const {
    return *number.at == 0.0 ? "\"auto\"" : (*this)(static_cast<const double*>(number.at));
  }
  std::string operator()(std::span<double> at) const {
    while (!at.empty() && at.back() == 0.0) at = at.first(at.size() - 1);
    std::string text;
    for (const double& number : at) text += (text.empty() ? "" : ", ") + (*this)(&number);
    return "[" + text + "]";
  }
  std::string operator()(const bool* at) const { return *at ? "true" : "false"; }
  std::string operator()(const std::string* at) const { return quoted(*at); }
  std::string operator()(const Choice& choice) const { return quoted(choice.words[choice.get()]); }
  template <typename Whole>
  std::string operator()(const Whole* at) const {
    return std::to_string(*at);
  }

  static std::string quoted(const std::string& value) {
    std::string text = "\"";
    for (const char c : value) {
      const unsigned code = static_cast<unsigned char>(c);
      if (code < 0x20 || code == 0x7f) {
        char escape[8];
        std::snprintf(escape, sizeof escape, "\\u%04X", code & 0xffU);
        text += escape;
        continue;
      }
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
    return text + "\"";
  }
};

}  // namespace

KeyLines read_settings(const std::filesystem::path& file, const Settings& settings,
                       Problems& problems) {
  const auto text = read_toml(file);
  if (text) return parse_settings(*text, settings, problems);
  problems.add(text.error());
  return {};
}

KeyLines parse_settings(std::string_view text, const Settings& settings, Problems& problems) {
  KeyLines lines;
  const toml::parse_result parsed = parse_toml(text);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    problems.add(static_cast<int>(error.source().begin.line), std::string(error.description()));
    return lines;
  }
  check_names(parsed.table(), "", settings, problems);
  for (const Setting& setting : settings) read_one(parsed.table(), setting, lines, problems);
  return lines;
}

std::string toml_value(const Setting& setting) {
  return std::visit(Write{}, setting.at);
}

std::string range_text(const Setting& setting) {
  if (const auto* choice = std::get_if<Choice>(&setting.at)) {
    std::string words;
    for (const std::string& word : choice->words) words += (words.empty() ? "" : ", ") + word;
    return words;
  }
  if (setting.max <= setting.min || !number_of(setting)) return {};
  char text[64];
  std::snprintf(text, sizeof text, "%s%.10g .. %.10g",
                std::holds_alternative<AutoNumber>(setting.at) ? "auto, " : "", setting.min,
                setting.max);
  return text;
}

std::pair<std::string, std::string> split_key(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return {"", key};
  return {key.substr(0, dot), key.substr(dot + 1)};
}

}  // namespace zenith
