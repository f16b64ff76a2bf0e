#pragma once
// Who may read the page: by the name under which it was asked, the page that asks, and a token that
// only this user knows.
//
// The name (Host) keeps out web sites whose own name is made to lead here (DNS rebinding), the
// origin other sites' pages, the token other users of this computer and, with --bind, of the
// network.

#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "tools/view/http_head.h"

namespace zenith::tools {

struct AccessRules {
  bool loopback = true;              // listening at this computer's own address
  std::vector<std::string> hosts;    // names by which it may be asked, besides literal addresses
  std::vector<std::string> origins;  // of other pages that may read: "https://example.org"
  std::string token;                 // empty: none is asked for
};

enum class Access { kAllowed, kForeignHost, kForeignOrigin, kNoToken };

// As "Host: anna.local:8765" names it, without the port and in small letters; "[::1]" is "::1".
std::string host_name(std::string_view host);
// An address in digits.
bool is_address(const std::string& host);
// localhost, 127.0.0.0/8 or ::1.
bool is_this_computer(const std::string& host);

// `secret`: whether what is asked for needs the token. The page's scripts, which are the same
// everywhere, do not.
Access judge_access(const AccessRules& rules, const HttpHead& head, bool secret);

// Takes as long for a wrong token as for the right one.
bool same_secret(std::string_view a, std::string_view b);

// 128 random bits in hexadecimal.
Result<std::string> new_token();
// The token in a file, which nobody but its owner and group may read. Where there is none, a new
// one is written, for the owner alone.
Result<std::string> token_of_file(const std::string& path);

}  // namespace zenith::tools
