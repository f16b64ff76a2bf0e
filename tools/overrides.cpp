#include "tools/overrides.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "platform/config/words.h"

namespace zenith::tools {
namespace {

std::optional<double> parse_number(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

const ParameterInfo* find_parameter(const std::string& key) {
  for (const ParameterInfo& info : parameter_table()) {
    if (info.key == key) return &info;
  }
  return nullptr;
}

std::string unknown_key(const std::string& key) {
  std::vector<std::string> known;
  for (const ParameterInfo& info : parameter_table()) known.emplace_back(info.key);
  std::string message = "unknown parameter '" + key + "'";
  const auto near = nearest_words(key, known);
  for (std::size_t i = 0; i < near.size(); ++i) {
    message += (i == 0 ? "; did you mean '" : "' or '") + near[i];
  }
  return message + (near.empty() ? "" : "'?");
}

// Empty when the assignment was applied, otherwise what is wrong with it.
std::string apply_one(Parameters& parameters, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    return "'" + assignment + "' is no assignment: write key=value";
  }
  const std::string key = assignment.substr(0, equals);
  const std::string text = assignment.substr(equals + 1);
  const ParameterInfo* info = find_parameter(key);
  if (info == nullptr) return unknown_key(key);
  const bool automatic = info->may_be_auto && text == "auto";
  const std::optional<double> value = automatic ? 0.0 : parse_number(text);
  if (!value) {
    return key + ": '" + text + "' is no number" + (info->may_be_auto ? ", nor auto" : "");
  }
  if (!automatic && (*value < info->min || *value > info->max)) {
    return key + ": " + text + " is outside " + number(info->min) + " .. " + number(info->max) +
           (info->unit.empty() ? "" : " " + std::string(info->unit));
  }
  if (const auto* real = std::get_if<double Parameters::*>(&info->field)) {
    parameters.*(*real) = *value;
    return {};
  }
  if (*value != std::floor(*value)) return key + ": " + text + " is no whole number";
  parameters.*(*std::get_if<int Parameters::*>(&info->field)) = static_cast<int>(*value);
  return {};
}

}  // namespace

Result<Parameters> apply_overrides(const Parameters& base,
                                   const std::vector<std::string>& assignments) {
  Parameters parameters = base;
  std::string problems;
  for (const std::string& assignment : assignments) {
    const std::string problem = apply_one(parameters, assignment);
    if (!problem.empty()) problems += (problems.empty() ? "--set " : "\n--set ") + problem;
  }
  if (!problems.empty()) return Error{problems};
  return parameters;
}

std::string describe_parameters() {
  const Parameters defaults;
  std::string text;
  for (const ParameterInfo& info : parameter_table()) {
    const auto* real = std::get_if<double Parameters::*>(&info.field);
    const double value =
        real != nullptr
            ? defaults.*(*real)
            : static_cast<double>(defaults.*(*std::get_if<int Parameters::*>(&info.field)));
    char line[256];
    std::snprintf(line, sizeof line, "  %-28s %-8s [%s .. %s] %s\n", std::string(info.key).c_str(),
                  info.may_be_auto && value == 0.0 ? "auto" : number(value).c_str(),
                  number(info.min).c_str(), number(info.max).c_str(),
                  std::string(info.unit).c_str());
    text += line;
    text += "      " + std::string(info.text) + "\n";
  }
  return text;
}

}  // namespace zenith::tools
