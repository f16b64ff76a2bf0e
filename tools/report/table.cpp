#include "tools/report/table.h"

#include <algorithm>
#include <cstdio>

namespace zenith::tools {
namespace {

// Columns on the screen: UTF-8 continuation bytes take none.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

}  // namespace

std::string Table::text(int indent) const {
  std::vector<std::size_t> widths;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    text.append(static_cast<std::size_t>(indent), ' ');
    for (std::size_t c = 0; c < rows_[r].size(); ++c) {
      const std::string& cell = rows_[r][c];
      const std::string padding(widths[c] - width_of(cell), ' ');
      text += (c == 0 ? "" : "  ") + (c == 0 ? cell + padding : padding + cell);
    }
    text += '\n';
    if (r > 0) continue;
    std::size_t rule = 2 * (widths.size() - 1);
    for (const std::size_t width : widths) rule += width;
    text += std::string(static_cast<std::size_t>(indent), ' ') + std::string(rule, '-') + '\n';
  }
  return text;
}

std::string fixed(std::optional<double> value, int decimals) {
  if (!value) return "-";
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, *value);
  return text;
}

std::string median_and_worst(std::vector<double> values, int decimals) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double median = n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
  return fixed(median, decimals) + " / " + fixed(values.back(), decimals);
}

}  // namespace zenith::tools
