#include "tools/view/web_access.h"

#include <arpa/inet.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "platform/linux/errno_text.h"
#include "platform/linux/input_file.h"
#include "platform/linux/whole_file.h"

namespace zenith::tools {
namespace {

constexpr std::size_t kShortest = 16;
constexpr std::size_t kLongest = 128;

bool is_ipv4(const std::string& text) {
  in_addr address = {};
  return ::inet_pton(AF_INET, text.c_str(), &address) == 1;
}

bool is_ipv6(const std::string& text) {
  in6_addr address = {};
  return ::inet_pton(AF_INET6, text.substr(0, text.find('%')).c_str(), &address) == 1;
}

bool is_listed(const std::vector<std::string>& list, std::string_view wanted) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& entry) {
    return small_letters(entry) == small_letters(wanted);
  });
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.substr(0, scheme.size()) == scheme) {
      return small_letters(origin.substr(scheme.size())) == small_letters(host);
    }
  }
  return false;
}

std::string_view token_of(const HttpHead& head) {
  const std::string_view in_address = head.parameter("token");
  if (!in_address.empty()) return in_address;
  const std::string* authorization = head.header("authorization");
  constexpr std::string_view kScheme = "bearer ";
  if (authorization == nullptr || authorization->size() <= kScheme.size()) return {};
  if (small_letters(authorization->substr(0, kScheme.size())) != kScheme) return {};
  return std::string_view(*authorization).substr(kScheme.size());
}

Error token_error(const std::string& path, const std::string& what) {
  return Error{path + ": " + what};
}

bool is_token_text(std::string_view text) {
  return text.size() >= kShortest && text.size() <= kLongest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '-' || c == '_';
         });
}

Result<std::string> write_token(const std::string& path) {
  auto token = new_token();
  if (!token) return token.error();
  const Status written = write_whole_file(path, *token + "\n", {.replace = false, .mode = 0600});
  if (!written) return token_error(path, "the new token " + written.error().message);
  return token;
}

}  // namespace

std::string host_name(std::string_view host) {
  if (!host.empty() && host[0] == '[') {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return "";
    const std::string_view rest = host.substr(end + 1);
    return rest.empty() || rest[0] == ':' ? small_letters(host.substr(1, end - 1)) : "";
  }
  const std::size_t colon = host.find(':');
  if (colon != host.rfind(':')) return "";
  return small_letters(host.substr(0, colon));
}

bool is_address(const std::string& host) {
  return is_ipv4(host) || is_ipv6(host);
}

bool is_this_computer(const std::string& host) {
  return host == "localhost" || host == "::1" || (is_ipv4(host) && host.substr(0, 4) == "127.");
}

Access judge_access(const AccessRules& rules, const HttpHead& head, bool secret) {
  const std::string* host = head.header("host");
  const std::string name = host == nullptr ? "" : host_name(*host);
  const bool known = is_this_computer(name) || (!rules.loopback && is_address(name)) ||
                     (!name.empty() && is_listed(rules.hosts, name));
  if (!known) return Access::kForeignHost;
  const std::string* origin = head.header("origin");
  if (origin != nullptr && *origin != "file://" && !is_own_origin(*origin, *host) &&
      !is_listed(rules.origins, *origin)) {
    return Access::kForeignOrigin;
  }
  if (!secret || rules.token.empty()) return Access::kAllowed;
  return same_secret(token_of(head), rules.token) ? Access::kAllowed : Access::kNoToken;
}

bool same_secret(std::string_view a, std::string_view b) {
  unsigned different = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const char other = a.empty() ? '\0' : a[i % a.size()];
    different |= static_cast<unsigned char>(other ^ b[i]);
  }
  // No compiler may end the loop above earlier.
  volatile unsigned result = different;
  return result == 0;
}

Result<std::string> new_token() {
  std::array<unsigned char, 16> bytes;
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    return Error{"no random numbers for a token: " + errno_text(errno)};
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 0xfU];
  }
  return token;
}

Result<std::string> token_of_file(const std::string& path) {
  if (::access(path.c_str(), F_OK) != 0 && errno == ENOENT) return write_token(path);
  const auto file = open_secret(path);
  if (!file) return file.error();
  std::array<char, kLongest + 2> text;
  const std::ptrdiff_t size = read_fully(file->fd.get(), text.data(), text.size());
  std::string_view token(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  if (!token.empty() && token.back() == '\n') token.remove_suffix(1);
  if (!is_token_text(token)) {
    return token_error(
        path,
        "expected one line of 16 to 128 letters, digits, - and _; a file that is not "
        "there is made");
  }
  return std::string(token);
}

}  // namespace zenith::tools
