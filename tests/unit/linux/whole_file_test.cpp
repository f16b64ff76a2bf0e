#include "platform/linux/whole_file.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::HasSubstr;
using tools::read_text;

class WholeFileTest : public testing::Test {
 protected:
  tools::TemporaryFolder folder_;
  const std::string path_ = (folder_.path() / "file").string();
};

// The limit of a file's size is met as a full disk is: in the middle of it.
TEST_F(WholeFileTest, AFullDiskLeavesTheOldFileAndNothingElse) {
  ASSERT_TRUE(write_whole_file(path_, "old").ok());
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit = {1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const Status written = write_whole_file(path_, std::string(5000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, handler);
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().message, HasSubstr("EFBIG"));
  EXPECT_EQ(read_text(path_), "old");
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
}

TEST_F(WholeFileTest, WhatMustNotBeReplacedStays) {
  ASSERT_TRUE(write_whole_file(path_, "one", {.replace = false}).ok());
  EXPECT_FALSE(write_whole_file(path_, "two", {.replace = false}).ok());
  EXPECT_EQ(read_text(path_), "one");
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
}

TEST_F(WholeFileTest, HasTheRightsThatWereAskedFor) {
  ASSERT_TRUE(write_whole_file(path_, "secret", {.mode = 0600}).ok());
  struct stat info = {};
  ASSERT_EQ(::stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777, 0600u);
  ASSERT_EQ(::chmod(path_.c_str(), 0640), 0);
  ASSERT_EQ(::stat(path_.c_str(), &info), 0);
  ASSERT_TRUE(write_whole_file(path_, "other", {.like = &info}).ok());
  ASSERT_EQ(::stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777, 0640u);
}

TEST_F(WholeFileTest, SaysWhatIsWrongWithThePlace) {
  EXPECT_FALSE(write_whole_file(folder_.path() / "none" / "file", "x").ok());
  EXPECT_FALSE(write_whole_file(folder_.path() / "", "x").ok());
  EXPECT_FALSE(write_whole_file("..", "x").ok());
  EXPECT_THAT(write_whole_file(folder_.path(), "x").error().message, HasSubstr("folder"));
  EXPECT_EQ(tools::entries(folder_.path()), 0u);
}

}  // namespace
}  // namespace zenith
