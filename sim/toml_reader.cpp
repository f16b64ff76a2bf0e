#include "sim/toml_reader.h"

#include <algorithm>
#include <cmath>

namespace zenith::sim {
namespace {

std::string plain(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

void TomlErrors::add(const toml::source_region& where, const std::string& message) {
  lines_.emplace_back(where.begin.line, message);
}

std::string TomlErrors::text() const {
  auto sorted = lines_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string all;
  for (const auto& [line, message] : sorted) {
    if (!all.empty()) all += '\n';
    all += file_ + ":" + std::to_string(line) + ": " + message;
  }
  return all;
}

const toml::node* TomlReader::find(std::string_view key, bool required) {
  asked_.emplace(key);
  const toml::node* node = table_.get(key);
  if (node == nullptr && required) {
    errors_.add(table_.source(), "the key \"" + std::string(key) + "\" is missing");
  }
  return node;
}

void TomlReader::fail(std::string_view key, const std::string& message) {
  const toml::node* node = table_.get(key);
  errors_.add(node != nullptr ? node->source() : table_.source(),
              std::string(key) + ": " + message);
}

void TomlReader::number(std::string_view key, double& value, double low, double high,
                        bool required) {
  const toml::node* node = find(key, required);
  if (node == nullptr) return;
  const auto found = node->value<double>();
  if (!found || !std::isfinite(*found)) {
    fail(key, "expected a number");
  } else if (*found < low || *found > high) {
    fail(key, "expected " + plain(low) + " to " + plain(high) + ", found " + plain(*found));
  } else {
    value = *found;
  }
}

void TomlReader::boolean(std::string_view key, bool& value) {
  const toml::node* node = find(key, false);
  if (node == nullptr) return;
  const auto found = node->value_exact<bool>();
  found ? void(value = *found) : fail(key, "expected true or false");
}

void TomlReader::text(std::string_view key, std::string& value, bool required) {
  const toml::node* node = find(key, required);
  if (node == nullptr) return;
  const auto found = node->value_exact<std::string>();
  found ? void(value = *found) : fail(key, "expected a text in quotes");
}

bool TomlReader::numbers(std::string_view key, double* values, std::size_t count, bool required) {
  const toml::node* node = find(key, required);
  if (node == nullptr) return false;
  const toml::array* list = node->as_array();
  if (list == nullptr || list->size() != count) {
    fail(key, "expected a list of " + std::to_string(count) + " numbers");
    return false;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = list->get(i)->value<double>();
    if (!found || !std::isfinite(*found)) {
      fail(key, "expected numbers only");
      return false;
    }
    values[i] = *found;
  }
  return true;
}

void TomlReader::coefficients(std::string_view key, std::span<double> values) {
  const toml::node* node = find(key, false);
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr || list->size() > values.size()) {
    fail(key, "expected a list of at most " + std::to_string(values.size()) + " numbers");
    return;
  }
  std::fill(values.begin(), values.end(), 0.0);
  numbers(key, values.data(), list->size(), false);
}

void TomlReader::points(std::string_view key, std::vector<std::pair<double, double>>& values) {
  const toml::node* node = find(key, true);
  if (node == nullptr) return;
  const toml::array* list = node->as_array();
  if (list == nullptr || list->size() < 2) {
    fail(key, "expected a list of at least two points [x, y]");
    return;
  }
  for (const toml::node& item : *list) {
    const toml::array* pair = item.as_array();
    const auto x = pair != nullptr && pair->size() == 2 ? pair->get(0)->value<double>()
                                                        : std::optional<double>{};
    const auto y = x ? pair->get(1)->value<double>() : std::optional<double>{};
    if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y)) {
      errors_.add(item.source(), std::string(key) + ": expected a point [x, y]");
      return;
    }
    values.emplace_back(*x, *y);
  }
}

const toml::table* TomlReader::table(std::string_view key) {
  const toml::node* node = find(key, false);
  if (node == nullptr) return nullptr;
  if (node->as_table() == nullptr) fail(key, "expected a table [" + std::string(key) + "]");
  return node->as_table();
}

std::vector<const toml::table*> TomlReader::tables(std::string_view key) {
  std::vector<const toml::table*> found;
  const toml::node* node = find(key, false);
  if (node == nullptr) return found;
  const toml::array* list = node->as_array();
  if (list == nullptr || !list->is_array_of_tables()) {
    fail(key, "expected tables [[" + std::string(key) + "]]");
    return found;
  }
  for (const toml::node& item : *list) found.push_back(item.as_table());
  return found;
}

void TomlReader::finish() {
  for (const auto& [key, node] : table_) {
    if (asked_.contains(key.str())) continue;
    errors_.add(key.source(), "unknown key \"" + std::string(key.str()) + "\"");
  }
}

}  // namespace zenith::sim
