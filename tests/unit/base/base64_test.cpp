#include "platform/base/base64.h"

#include <string>

#include <gtest/gtest.h>

namespace zenith {
namespace {

std::string written(std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  std::string out(base64_size(bytes.size()), ' ');
  write_base64(bytes, out.data());
  return out;
}

// The vectors of RFC 4648, section 10.
TEST(Base64, IsTheStandards) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, code] : vectors) {
    EXPECT_EQ(written(text), code);
    const auto read = read_base64(code);
    ASSERT_TRUE(read) << code;
    EXPECT_EQ(std::string(read->begin(), read->end()), text);
  }
}

TEST(Base64, RefusesWhatIsNone) {
  for (const char* wrong : {"Zg", "Zg=", "Z===", "=Zg=", "Zm=v", "Zm9*", "Zm9vZg==Zm9v"}) {
    EXPECT_FALSE(read_base64(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace zenith
