// Who may read the page.

#include "tools/view/web_access.h"

#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

using testing::HasSubstr;

HttpHead head_of(const std::string& headers, const std::string& target = "/") {
  const ParsedHead parsed = parse_http_head("GET " + target + " HTTP/1.1\r\n" + headers + "\r\n");
  EXPECT_EQ(parsed.fault, HeadFault::kNone) << headers;
  return parsed.head;
}
HttpHead asked_as(const std::string& host) {
  return head_of("Host: " + host + "\r\n");
}

TEST(WebAccess, ThisComputersAddressAnswersToItsNamesAlone) {
  const AccessRules rules;
  for (const char* host :
       {"localhost", "LOCALHOST:8765", "127.0.0.1:8765", "127.1.2.3", "[::1]:80", "[::1]"}) {
    EXPECT_EQ(judge_access(rules, asked_as(host), true), Access::kAllowed) << host;
  }
  for (const char* host :
       {"evil.example", "evil.example:8765", "192.168.1.4", "[fe80::1]", "127.0.0.1.evil.example",
        "127.evil.example", "localhost.", "1.1", "[::1", "[::1]x", "::1", "a@127.0.0.1", ""}) {
    EXPECT_EQ(judge_access(rules, asked_as(host), true), Access::kForeignHost) << host;
  }
  EXPECT_EQ(judge_access(rules, head_of(""), true), Access::kForeignHost);
}

TEST(WebAccess, AnotherAddressAnswersToDigitsAndToNamesThatWereGiven) {
  AccessRules rules;
  rules.loopback = false;
  rules.hosts = {"Desk.local"};
  for (const char* host : {"192.168.1.4:8765", "[fe80::1]:8765", "desk.local", "DESK.LOCAL:8765",
                           "127.0.0.1", "localhost:1"}) {
    EXPECT_EQ(judge_access(rules, asked_as(host), true), Access::kAllowed) << host;
  }
  for (const char* host : {"evil.example", "192.168.1.4.evil.example", "desk.local.evil.example"}) {
    EXPECT_EQ(judge_access(rules, asked_as(host), true), Access::kForeignHost) << host;
  }
}

TEST(WebAccess, PagesOfOtherSitesAreTurnedAway) {
  AccessRules rules;
  rules.origins = {"https://app.foxglove.dev"};
  const auto from = [&](const std::string& origin) {
    return judge_access(rules, head_of("Host: 127.0.0.1:8765\r\nOrigin: " + origin + "\r\n"), true);
  };
  for (const char* origin : {"http://127.0.0.1:8765", "https://app.foxglove.dev", "file://"}) {
    EXPECT_EQ(from(origin), Access::kAllowed) << origin;
  }
  for (const char* origin :
       {"https://evil.example", "http://127.0.0.1:9000", "http://localhost:8765", "null",
        "https://app.foxglove.dev.evil.example", "127.0.0.1:8765"}) {
    EXPECT_EQ(from(origin), Access::kForeignOrigin) << origin;
  }
}

TEST(WebAccess, TheTokenStandsInTheAddressOrTheHeader) {
  AccessRules rules;
  rules.token = "0123456789abcdef";
  const std::string host = "Host: 127.0.0.1\r\n";
  EXPECT_EQ(judge_access(rules, head_of(host, "/?token=0123456789abcdef"), true), Access::kAllowed);
  EXPECT_EQ(judge_access(rules, head_of(host + "Authorization: Bearer 0123456789abcdef\r\n"), true),
            Access::kAllowed);
  for (const HttpHead& head :
       {head_of(host), head_of(host, "/?token="), head_of(host, "/?token=0123456789abcde"),
        head_of(host, "/?token=0123456789abcdef0"), head_of(host, "/?token=0123456789abcdeF"),
        head_of(host + "Authorization: Basic 0123456789abcdef\r\n"),
        head_of(host + "Authorization: Bearer\r\n")}) {
    EXPECT_EQ(judge_access(rules, head, true), Access::kNoToken);
    EXPECT_EQ(judge_access(rules, head, false), Access::kAllowed) << "a script";
  }
}

TEST(WebAccess, SecretsAreComparedWhole) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abcd", "abd", "xbc", "abcabc"}) {
    EXPECT_FALSE(same_secret(other, "abc")) << other;
  }
  EXPECT_NE(*new_token(), *new_token());
  EXPECT_EQ(new_token()->size(), 32u);
}

TEST(WebAccess, ATokenFileIsMadeOnceAndNobodyElsesToRead) {
  TemporaryFolder folder;
  const std::string path = (folder.path() / "token").string();
  const auto made = token_of_file(path);
  ASSERT_TRUE(made.ok()) << made.error().message;
  struct stat about = {};
  ASSERT_EQ(::stat(path.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777U, 0600U);
  EXPECT_EQ(*token_of_file(path), *made) << "the same at the next start";
  ASSERT_EQ(::chmod(path.c_str(), 0644), 0);
  EXPECT_THAT(token_of_file(path).error().message, HasSubstr("chmod"));
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  EXPECT_TRUE(token_of_file(path).ok());
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown(path.c_str(), 65534, 0), 0);
    EXPECT_THAT(token_of_file(path).error().message, HasSubstr("belongs to user 65534"));
    ASSERT_EQ(::chown(path.c_str(), 0, 0), 0);
  }
  for (const std::string& text :
       {std::string("short\n"), std::string("0123456789abcdef\nmore\n"), std::string(200, 'a'),
        std::string("0123456789abcde\x1b\n"), std::string()}) {
    write_text(path, text);
    EXPECT_THAT(token_of_file(path).error().message, HasSubstr("16 to 128")) << text;
  }
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(token_of_file(pipe).error().message, HasSubstr("expected a regular file"));
  // Nobody's link is followed where a new one is written.
  const std::string link = (folder.path() / "link").string();
  std::filesystem::create_symlink(folder.path() / "elsewhere", link);
  EXPECT_FALSE(token_of_file(link).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "elsewhere"));
}

}  // namespace
}  // namespace zenith::tools
