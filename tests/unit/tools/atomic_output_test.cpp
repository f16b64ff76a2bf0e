#include "tools/atomic_output.h"

#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(AtomicFolder, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "deep" / "out";
  auto output = AtomicFolder::create(target, false, "marker");
  ASSERT_TRUE(output.ok());
  write_text(output->path() / "marker", "x");
  EXPECT_FALSE(fs::exists(target));
  ASSERT_TRUE(output->commit().ok());
  EXPECT_EQ(read_text(target / "marker"), "x");
  EXPECT_EQ(entries(target.parent_path()), 1U);
}

TEST(AtomicFolder, LeavesNothingWhenDropped) {
  const TemporaryFolder folder;
  try {
    auto output = AtomicFolder::create(folder.path() / "out", false, "marker");
    ASSERT_TRUE(output.ok());
    write_text(output->path() / "half", "written");
    throw std::runtime_error("an error on the way");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(entries(folder.path()), 0U);
}

TEST(AtomicFolder, ReplacesOnlyWithForceAndOnlyItsOwnKind) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  fs::create_directory(target);
  EXPECT_TRUE(AtomicFolder::create(target, false, "marker").ok()) << "an empty folder may be used";
  write_text(target / "precious", "data");
  const auto plain = AtomicFolder::create(target, false, "marker");
  ASSERT_FALSE(plain.ok());
  EXPECT_THAT(plain.error().message, HasSubstr("--force"));
  const auto forced = AtomicFolder::create(target, true, "marker");
  ASSERT_FALSE(forced.ok());
  EXPECT_THAT(forced.error().message, HasSubstr("holds no marker"));
  EXPECT_EQ(read_text(target / "precious"), "data");

  write_text(target / "marker", "old");
  auto allowed = AtomicFolder::create(target.string() + "/", true, "marker");
  ASSERT_TRUE(allowed.ok());
  write_text(allowed->path() / "marker", "new");
  EXPECT_EQ(read_text(target / "marker"), "old") << "until it is committed";
  ASSERT_TRUE(allowed->commit().ok());
  EXPECT_EQ(read_text(target / "marker"), "new");
  EXPECT_FALSE(fs::exists(target / "precious"));
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(AtomicFolder, RefusesAFileInItsPlace) {
  const TemporaryFolder folder;
  write_text(folder.path() / "out", "a file");
  EXPECT_FALSE(AtomicFolder::create(folder.path() / "out", true, "marker").ok());
  EXPECT_FALSE(AtomicFolder::create(folder.path() / "out" / "in", true, "marker").ok());
}

TEST(AtomicFolder, SweepsWhatAKilledProcessLeft) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto output = AtomicFolder::create(target, false, "marker");
    if (output.ok()) write_text(output->path() / "half", "written");
    _exit(0);  // no destructor runs
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(entries(folder.path()), 1U) << "the child's rest";
  auto output = AtomicFolder::create(target, false, "marker");
  ASSERT_TRUE(output.ok());
  EXPECT_EQ(entries(folder.path()), 1U) << "only our own";
  ASSERT_TRUE(output->commit().ok());
  EXPECT_EQ(entries(target), 0U);
}

TEST(WriteFile, ReplacesWhole) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "file";
  ASSERT_TRUE(write_file(path, "one").ok());
  ASSERT_TRUE(write_file(path, "two").ok());
  EXPECT_EQ(read_text(path), "two");
  EXPECT_EQ(entries(folder.path()), 1U);
  EXPECT_FALSE(write_file(folder.path() / "none" / "file", "x").ok());
}

}  // namespace
}  // namespace zenith::tools
