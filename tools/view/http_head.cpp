#include "tools/view/http_head.h"

#include <algorithm>

namespace zenith::tools {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

bool is_token(std::string_view text) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           kMarks.find(c) != std::string_view::npos;
  });
}

// Printable bytes, tabs and those of other encodings.
bool is_value(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    return c == '\t' || (static_cast<unsigned char>(c) >= 0x20 && c != '\x7f');
  });
}

bool is_target(std::string_view text) {
  return !text.empty() && text[0] == '/' &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// "GET /path?query HTTP/1.1"
bool read_request_line(std::string_view line, HttpHead& head) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return false;
  const std::string_view version = line.substr(last + 1);
  const std::string_view target = line.substr(first + 1, last - first - 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") return false;
  if (!is_token(line.substr(0, first)) || !is_target(target)) return false;
  const std::size_t mark = std::min(target.find('?'), target.size());
  head.method = line.substr(0, first);
  head.path = target.substr(0, mark);
  head.query = target.substr(std::min(mark + 1, target.size()));
  return true;
}

// Two of a kind would be read differently by whoever stands before this server.
bool may_repeat(std::string_view name) {
  constexpr std::string_view kOnce[] = {"host",
                                        "origin",
                                        "authorization",
                                        "content-length",
                                        "transfer-encoding",
                                        "upgrade",
                                        "sec-websocket-key",
                                        "sec-websocket-version"};
  return std::find(std::begin(kOnce), std::end(kOnce), name) == std::end(kOnce);
}

bool read_header(std::string_view line, HttpHead& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) return false;
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (!is_value(value) || head.headers.size() >= HttpHead::kMostHeaders) return false;
  std::string name = small_letters(line.substr(0, colon));
  if (!may_repeat(name) && head.header(name) != nullptr) return false;
  head.headers.emplace_back(std::move(name), value);
  return true;
}

}  // namespace

std::string small_letters(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

const std::string* HttpHead::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return &value;
  }
  return nullptr;
}

std::string_view HttpHead::parameter(std::string_view name) const {
  std::string_view rest = query;
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    if (one.size() > name.size() && one[name.size()] == '=' && one.substr(0, name.size()) == name) {
      return one.substr(name.size() + 1);
    }
  }
  return {};
}

bool HttpHead::lists(std::string_view name, std::string_view word) const {
  for (const auto& [key, value] : headers) {
    if (key != name) continue;
    std::string_view rest = value;
    while (!rest.empty()) {
      const std::string_view one = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(one.size() + 1, rest.size()));
      if (small_letters(trimmed(one)) == small_letters(word)) return true;
    }
  }
  return false;
}

ParsedHead parse_http_head(std::string_view bytes) {
  ParsedHead out;
  const std::size_t end = bytes.substr(0, HttpHead::kMostBytes).find("\r\n\r\n");
  if (end == std::string_view::npos) {
    if (bytes.size() >= HttpHead::kMostBytes) out.fault = HeadFault::kTooLong;
    return out;
  }
  out.bytes = end + 4;
  std::string_view rest = bytes.substr(0, end + 2);
  bool good = true;
  for (bool first = true; good && !rest.empty(); first = false) {
    const std::size_t line = rest.find(kLineEnd);
    good = first ? read_request_line(rest.substr(0, line), out.head)
                 : read_header(rest.substr(0, line), out.head);
    rest.remove_prefix(line + kLineEnd.size());
  }
  out.fault = good ? HeadFault::kNone : HeadFault::kMalformed;
  return out;
}

}  // namespace zenith::tools
