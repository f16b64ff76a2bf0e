#pragma once
// The head of an HTTP/1 request, read strictly (RFC 9112): what is unusual is refused. Bodies are
// not read: the page's server answers GET alone.

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace zenith::tools {

struct HttpHead {
  static constexpr std::size_t kMostBytes = 8192;
  static constexpr std::size_t kMostHeaders = 64;

  std::string method;
  std::string path;   // before the "?", as it came: "/metrics"
  std::string query;  // behind it
  std::vector<std::pair<std::string, std::string>> headers;  // names in small letters

  // The first one of this name (in small letters); null: there is none.
  const std::string* header(std::string_view name) const;
  // "abc" of "?a=1&token=abc", as it came; empty: there is none.
  std::string_view parameter(std::string_view name) const;
  // Whether a list such as "keep-alive, Upgrade" has this word, in any case.
  bool lists(std::string_view header, std::string_view word) const;
};

enum class HeadFault { kNone, kIncomplete, kTooLong, kMalformed };

struct ParsedHead {
  HeadFault fault = HeadFault::kIncomplete;
  HttpHead head;
  std::size_t bytes = 0;  // of the head, with its empty line
};
ParsedHead parse_http_head(std::string_view bytes);

std::string small_letters(std::string_view text);  // ASCII's

}  // namespace zenith::tools
