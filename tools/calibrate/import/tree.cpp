#include "tools/calibrate/import/tree.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "platform/base/printable.h"

namespace zenith::tools {
namespace {

std::size_t size_of(const Node& node) {
  std::size_t size = 1;
  for (const Node& child : node.children) size += size_of(child);
  return size;
}

std::size_t depth_of(const Node& node) {
  std::size_t depth = 0;
  for (const Node& child : node.children) depth = std::max(depth, depth_of(child));
  return depth + 1;
}

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Words that stand for no finite number.
double special_number(std::string_view word) {
  const bool minus = word.starts_with('-');
  if (minus || word.starts_with('+')) word.remove_prefix(1);
  if (word.starts_with('.')) word.remove_prefix(1);
  const std::string name = lower(word);
  if (name == "inf" || name == "infinity") {
    return minus ? -std::numeric_limits<double>::infinity()
                 : std::numeric_limits<double>::infinity();
  }
  return name == "nan" ? std::numeric_limits<double>::quiet_NaN() : 0.0;
}

Status read_number(std::string_view word, std::vector<double>& out) {
  double value = 0.0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code == std::errc() && end == digits.data() + digits.size()) {
    out.push_back(value);
    return {};
  }
  // Too small for a double is zero; what is too large is refused as infinite later.
  if (code == std::errc::result_out_of_range && end == digits.data() + digits.size()) {
    const bool tiny = digits.find("e-") != digits.npos || digits.find("E-") != digits.npos;
    out.push_back(tiny ? 0.0 : std::numeric_limits<double>::infinity());
    return {};
  }
  const double special = special_number(word);
  if (special == 0.0) return Error{"'" + printable_start(word, 40) + "' is no number"};
  out.push_back(special);
  return {};
}

Status append_numbers(std::string_view text, std::vector<double>& out) {
  const auto between = [](char c) { return is_space(c) || c == ',' || c == '[' || c == ']'; };
  std::size_t at = 0;
  while (true) {
    while (at < text.size() && between(text[at])) ++at;
    if (at == text.size()) return {};
    std::size_t end = at;
    while (end < text.size() && !between(text[end])) ++end;
    if (const Status read = read_number(text.substr(at, end - at), out); !read) return read;
    at = end;
  }
}

// How many numbers a matrix says it has: rows times cols, times the channels of OpenCV's dt ("2d").
std::optional<double> matrix_size(const Node& map) {
  double size = 1.0;
  for (const std::string_view key : {"rows", "cols"}) {
    const Node* side = find(map, {key});
    const auto number =
        side == nullptr ? Result<std::vector<double>>(std::vector<double>()) : numbers_of(*side);
    if (!number || number->size() != 1 || !(number->front() >= 1.0 && number->front() < 1e6)) {
      return std::nullopt;
    }
    size *= number->front();
  }
  const Node* type = find(map, {"dt"});
  if (type != nullptr && !type->text.empty() && type->text[0] >= '1' && type->text[0] <= '9') {
    size *= type->text[0] - '0';
  }
  return size;
}

Status append_numbers(const Node& node, std::vector<double>& out) {
  if (node.is_scalar()) return append_numbers(node.text, out);
  if (node.is_map()) {
    const Node* data = find(node, {"data"});
    if (data == nullptr) return Error{"expected numbers, found keys"};
    const std::size_t before = out.size();
    if (const Status read = append_numbers(*data, out); !read) return read;
    const auto expected = matrix_size(node);
    // Zeros behind the last coefficient say nothing.
    while (expected && static_cast<double>(out.size() - before) > *expected && out.back() == 0.0) {
      out.pop_back();
    }
    if (!expected || *expected == static_cast<double>(out.size() - before)) return {};
    return Error{std::to_string(out.size() - before) + " numbers where rows times cols are " +
                 std::to_string(static_cast<long>(*expected)) +
                 ": the file was cut off or edited; correct rows and cols, or take the file anew"};
  }
  for (const Node& child : node.children) {
    if (const Status read = append_numbers(child, out); !read) return read;
  }
  return {};
}

}  // namespace

bool TreeBuilder::add(Node node) {
  if (has_key_) node.key = std::exchange(key_, {});
  has_key_ = false;
  if (open_.empty()) {
    root_ = std::move(node);
  } else {
    open_.back().children.push_back(std::move(node));
  }
  return true;
}

bool TreeBuilder::begin(Node::Kind kind) {
  if (open_.size() == kMostDepth || ++nodes_ > kMostNodes) return false;
  Node node;
  node.kind = kind;
  if (has_key_) node.key = std::exchange(key_, {});
  has_key_ = false;
  open_.push_back(std::move(node));
  return true;
}

bool TreeBuilder::end() {
  if (open_.empty()) return false;
  Node node = std::move(open_.back());
  open_.pop_back();
  // Its key came with it.
  if (open_.empty()) {
    root_ = std::move(node);
  } else {
    open_.back().children.push_back(std::move(node));
  }
  return true;
}

bool TreeBuilder::scalar(std::string text) {
  if (++nodes_ > kMostNodes) return false;
  Node node;
  node.text = std::move(text);
  return add(std::move(node));
}

bool TreeBuilder::key(std::string text) {
  key_ = std::move(text);
  has_key_ = true;
  return true;
}

bool TreeBuilder::insert(const Node& node) {
  nodes_ += size_of(node);
  if (nodes_ > kMostNodes || open_.size() + depth_of(node) > kMostDepth) return false;
  Node copy = node;
  copy.key.clear();
  return add(std::move(copy));
}

const Node& TreeBuilder::last() const {
  return open_.empty() || open_.back().children.empty() ? root_ : open_.back().children.back();
}

std::string plain_key(std::string_view key) {
  std::string plain;
  for (const char c : key) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return plain;
}

const Node* find(const Node& map, std::initializer_list<std::string_view> names) {
  if (!map.is_map()) return nullptr;
  for (const std::string_view name : names) {
    for (const Node& child : map.children) {
      if (plain_key(child.key) == name) return &child;
    }
  }
  return nullptr;
}

Result<std::vector<double>> numbers_of(const Node& node) {
  std::vector<double> numbers;
  if (const Status read = append_numbers(node, numbers); !read) return read.error();
  return numbers;
}

Result<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  if (const Status read = append_numbers(text, numbers); !read) return read.error();
  return numbers;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace zenith::tools
