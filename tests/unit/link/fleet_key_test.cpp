#include "platform/link/fleet_key.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::HasSubstr;
using tools::read_text;

class FleetKeyTest : public testing::Test {
 protected:
  void write(const std::string& text, mode_t mode = 0600) {
    tools::write_text(file_, text);
    ASSERT_EQ(::chmod(file_.c_str(), mode), 0);
  }
  std::string error() const {
    const auto keys = read_fleet_keys(file_);
    return keys.ok() ? "" : keys.error().message;
  }
  mode_t mode() const {
    struct stat info = {};
    ::stat(file_.c_str(), &info);
    return info.st_mode & 07777;
  }

  tools::TemporaryFolder folder_;
  const std::string file_ = (folder_.path() / "fleet.key").string();
  const std::string base64_ = "AwoRGB8mLTQ7QklQV15lbHN6gYiPlp2kq7K5wMfO1dw=";  // 3, 10, 17, ...
  const std::string hex_ = "030a11181f262d343b424950575e656c737a81888f969da4abb2b9c0c7ced5dc";
};

TEST_F(FleetKeyTest, ReadsBase64AndHex) {
  write("zenith-fleet-key 1\n# a comment\n\n  " + base64_ + " \r\n");
  auto keys = read_fleet_keys(file_);
  ASSERT_TRUE(keys.ok()) << keys.error().message;
  EXPECT_EQ(keys->current.bytes()[1], 10);
  EXPECT_EQ(keys->current.bytes()[31], 0xDC);
  EXPECT_FALSE(keys->has_previous);
  const SecretKey first = keys->current;

  write("zenith-fleet-key 1\n" + hex_);
  keys = read_fleet_keys(file_);
  ASSERT_TRUE(keys.ok()) << keys.error().message;
  EXPECT_TRUE(keys->current == first);
  EXPECT_EQ(hint_text(key_hint(first)), "2439");
}

TEST_F(FleetKeyTest, AnEditorsMarkIsPassedOver) {
  write("\xef\xbb\xbfzenith-fleet-key 1\r\n" + hex_ + "\r\n");
  EXPECT_EQ(error(), "");
}

TEST_F(FleetKeyTest, ReadsThePreviousKey) {
  write("zenith-fleet-key 1\n" + std::string(64, 'a') + "\n" + hex_ + "\n");
  const auto keys = read_fleet_keys(file_);
  ASSERT_TRUE(keys.ok()) << keys.error().message;
  EXPECT_TRUE(keys->has_previous);
  EXPECT_EQ(keys->current.bytes()[0], 0xAA);
  EXPECT_EQ(keys->previous.bytes()[0], 3);
}

TEST_F(FleetKeyTest, SaysWhatIsWrong) {
  EXPECT_THAT(error(), HasSubstr("zenith key new"));
  write("");
  EXPECT_THAT(error(), HasSubstr("does not begin with the line \"zenith-fleet-key 1\""));
  write("-----BEGIN OPENSSH PRIVATE KEY-----\n");
  EXPECT_THAT(error(), HasSubstr("is it a key file?"));
  write("zenith-fleet-key 1\n");
  EXPECT_THAT(error(), HasSubstr("holds no key"));
  for (const std::string& bad :
       {hex_ + "0", hex_.substr(1), base64_.substr(4), "x" + hex_.substr(1), base64_ + base64_,
        base64_.substr(0, 43) + "!"}) {
    write("zenith-fleet-key 1\n" + bad + "\n");
    EXPECT_THAT(error(), HasSubstr("its key is not 32 bytes")) << bad;
  }
  write("zenith-fleet-key 1\n" + hex_ + "\nold\n");
  EXPECT_THAT(error(), HasSubstr("its second key is not 32 bytes"));
  write("zenith-fleet-key 1\n" + hex_ + "\n" + hex_ + "\n" + hex_ + "\n");
  EXPECT_THAT(error(), HasSubstr("more than two"));
  write("zenith-fleet-key 1\n" + std::string(64, '0') + "\n");
  EXPECT_THAT(error(), HasSubstr("all zeros"));
  write("zenith-fleet-key 1\n" + std::string(5000, '#') + "\n");
  EXPECT_THAT(error(), HasSubstr("longer than a key file"));
  EXPECT_THAT(read_fleet_keys(folder_.path()).error().message,
              HasSubstr("expected a regular file"));
}

TEST_F(FleetKeyTest, WhatOthersMayReadOrWriteIsNoSecret) {
  const std::string good = "zenith-fleet-key 1\n" + hex_ + "\n";
  for (const mode_t mode : {0600, 0400, 0640, 0440}) {
    write(good, mode);
    EXPECT_EQ(error(), "") << std::oct << mode;
  }
  for (const mode_t mode : {0644, 0604, 0602, 0601, 0666}) {
    write(good, mode);
    EXPECT_THAT(error(), HasSubstr("chmod 6")) << std::oct << mode;
    EXPECT_THAT(error(), HasSubstr("zenith key rotate " + file_));
  }
  write(good, 0660);
  EXPECT_THAT(error(), HasSubstr("chmod 640 " + file_));
  if (::geteuid() != 0) return;
  write(good, 0600);
  ASSERT_EQ(::chown(file_.c_str(), 12345, 0), 0);
  EXPECT_THAT(error(), HasSubstr("belongs to user 12345"));
}

TEST_F(FleetKeyTest, MakesKeysThatDiffer) {
  ASSERT_TRUE(create_fleet_key(file_).ok());
  EXPECT_EQ(mode(), 0600u);
  const auto first = read_fleet_keys(file_);
  ASSERT_TRUE(first.ok()) << first.error().message;
  EXPECT_FALSE(first->has_previous);

  const std::string before = read_text(file_);
  const Status again = create_fleet_key(file_);
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(again.error().message, HasSubstr("zenith key rotate"));
  EXPECT_EQ(read_text(file_), before);

  ASSERT_EQ(::unlink(file_.c_str()), 0);
  ASSERT_TRUE(create_fleet_key(file_).ok());
  EXPECT_FALSE(read_fleet_keys(file_)->current == first->current);
}

TEST_F(FleetKeyTest, RotatesAndKeepsRights) {
  ASSERT_TRUE(create_fleet_key(file_).ok());
  ASSERT_EQ(::chmod(file_.c_str(), 0640), 0);
  const auto first = read_fleet_keys(file_);
  ASSERT_TRUE(first.ok());
  ASSERT_TRUE(rotate_fleet_key(file_).ok());
  EXPECT_EQ(mode(), 0640u);
  const auto second = read_fleet_keys(file_);
  ASSERT_TRUE(second.ok()) << second.error().message;
  ASSERT_TRUE(second->has_previous);
  EXPECT_TRUE(second->previous == first->current);
  EXPECT_FALSE(second->current == first->current);
  ASSERT_TRUE(rotate_fleet_key(file_).ok());
  const auto third = read_fleet_keys(file_);
  ASSERT_TRUE(third.ok()) << third.error().message;
  EXPECT_TRUE(third->previous == second->current);
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
}

// As on a disk that becomes full in the middle of the file.
class ShortFiles {
 public:
  explicit ShortFiles(rlim_t bytes) {
    handler_ = ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~ShortFiles() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    ::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  sighandler_t handler_ = SIG_DFL;
};

TEST_F(FleetKeyTest, AFullDiskLeavesNothingBehindAndTheNextCallSucceeds) {
  {
    const ShortFiles full(20);
    const Status made = create_fleet_key(file_);
    ASSERT_FALSE(made.ok());
    EXPECT_THAT(made.error().message, HasSubstr("key file " + file_ + ": cannot be written"));
  }
  EXPECT_EQ(tools::entries(folder_.path()), 0u);
  ASSERT_TRUE(create_fleet_key(file_).ok());
  ASSERT_TRUE(rotate_fleet_key(file_).ok());
  const std::string before = read_text(file_);
  for (const auto change : {rotate_fleet_key, swap_fleet_keys}) {
    const ShortFiles full(20);
    EXPECT_FALSE(change(file_).ok());
  }
  EXPECT_EQ(read_text(file_), before);
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
  EXPECT_TRUE(rotate_fleet_key(file_).ok());
}

TEST_F(FleetKeyTest, ALinkInThePlaceOfTheFileIsNotFollowed) {
  const std::string other = (folder_.path() / "other").string();
  ASSERT_EQ(::symlink(other.c_str(), file_.c_str()), 0);
  EXPECT_FALSE(create_fleet_key(file_).ok());
  EXPECT_EQ(tools::entries(folder_.path()), 1u) << "the link alone";
}

// Replaced by the new file it would lead nowhere, and who reads the file itself would keep the old
// key.
TEST_F(FleetKeyTest, ALinkIsReadAndNotChanged) {
  ASSERT_TRUE(create_fleet_key(file_).ok());
  ASSERT_TRUE(rotate_fleet_key(file_).ok());
  const std::string link = (folder_.path() / "link").string();
  ASSERT_EQ(::symlink(file_.c_str(), link.c_str()), 0);
  EXPECT_TRUE(read_fleet_keys(link).ok());
  const std::string before = read_text(file_);
  for (const auto change : {rotate_fleet_key, swap_fleet_keys}) {
    const Status refused = change(link);
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().message, HasSubstr("name the file itself: " + file_));
  }
  EXPECT_EQ(read_text(file_), before);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST_F(FleetKeyTest, SwapsTwoKeys) {
  ASSERT_TRUE(create_fleet_key(file_).ok());
  const Status single = swap_fleet_keys(file_);
  ASSERT_FALSE(single.ok());
  EXPECT_THAT(single.error().message, HasSubstr("holds one key"));
  ASSERT_TRUE(rotate_fleet_key(file_).ok());
  const auto before = read_fleet_keys(file_);
  ASSERT_TRUE(swap_fleet_keys(file_).ok());
  const auto after = read_fleet_keys(file_);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_TRUE(after->has_previous);
  EXPECT_TRUE(after->current == before->previous);
  EXPECT_TRUE(after->previous == before->current);
  const std::string hints = hint_text(key_hint(after->current)) + "; " +
                            hint_text(key_hint(after->previous)) + " only opens";
  EXPECT_EQ(keys_text(*after), hints);
}

TEST_F(FleetKeyTest, AWrongFileIsNotRotated) {
  write("zenith-fleet-key 1\nnonsense\n");
  EXPECT_FALSE(rotate_fleet_key(file_).ok());
  EXPECT_EQ(read_text(file_), "zenith-fleet-key 1\nnonsense\n");
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
}

}  // namespace
}  // namespace zenith
