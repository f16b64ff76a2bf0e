#pragma once
// A table of text for a terminal: the first column flush left, all others flush right.

#include <optional>
#include <string>
#include <vector>

namespace zenith::tools {

class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.size() < 2; }

  // Lines with `indent` spaces in front, a rule under the header.
  std::string text(int indent) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// A number with so many decimals; "-" when there is none.
std::string fixed(std::optional<double> value, int decimals);

// "median / worst", worst being the largest; "-" when there is no value.
std::string median_and_worst(std::vector<double> values, int decimals);

}  // namespace zenith::tools
