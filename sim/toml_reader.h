#pragma once
// Typed reading of a TOML table that remembers which keys were asked for: what was never asked for
// is an unknown key. Errors collect as "file:line: message".

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/config/toml_text.h"

namespace zenith::sim {

class TomlErrors {
 public:
  explicit TomlErrors(std::string file) : file_(std::move(file)) {}
  void add(const toml::source_region& where, const std::string& message);
  bool empty() const { return lines_.empty(); }
  std::string text() const;

 private:
  std::string file_;
  std::vector<std::pair<unsigned, std::string>> lines_;
};

// Views a table that must outlive it. Missing keys leave the value as it is unless required.
class TomlReader {
 public:
  TomlReader(const toml::table& table, TomlErrors& errors) : table_(table), errors_(errors) {}

  void number(std::string_view key, double& value, double low, double high, bool required = false);
  void boolean(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value, bool required = false);
  bool has(std::string_view key) const { return table_.contains(key); }
  // Exactly `count` numbers.
  bool numbers(std::string_view key, double* values, std::size_t count, bool required);
  // At most values.size() numbers; zeros behind them.
  void coefficients(std::string_view key, std::span<double> values);
  // A list of [x, y].
  void points(std::string_view key, std::vector<std::pair<double, double>>& values);

  template <typename E, std::size_t N>
  void choice(std::string_view key, E& value, const std::pair<std::string_view, E> (&names)[N]) {
    std::string word;
    text(key, word);
    if (word.empty()) return;
    std::string known;
    for (const auto& [name, meaning] : names) {
      if (word == name) {
        value = meaning;
        return;
      }
      known += known.empty() ? std::string(name) : ", " + std::string(name);
    }
    fail(key, "expected one of " + known + ", found \"" + word + "\"");
  }

  // Sub-table, or nullptr.
  const toml::table* table(std::string_view key);
  std::vector<const toml::table*> tables(std::string_view key);
  void fail(std::string_view key, const std::string& message);
  // Reports every key that nobody asked for. Call last.
  void finish();

 private:
  const toml::node* find(std::string_view key, bool required);

  const toml::table& table_;
  TomlErrors& errors_;
  std::set<std::string, std::less<>> asked_;
};

}  // namespace zenith::sim
