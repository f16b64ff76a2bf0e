#include "tools/atomic_output.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <stdexcept>
#include <thread>

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

// Left by a process that was killed between the two steps: the older output is not lost.
TEST(AtomicFolder, AnOlderOutputThatGaveWayComesBack) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  fs::create_directory(folder.path() / ".out.old-0123456789abcdef");
  write_text(folder.path() / ".out.old-0123456789abcdef" / "marker", "old");
  { ASSERT_TRUE(AtomicFolder::create(target, true, "marker").ok()); }
  EXPECT_EQ(read_text(target / "marker"), "old");
  EXPECT_EQ(entries(folder.path()), 1U);
  // And behind an output that is whole it goes.
  fs::create_directory(folder.path() / ".out.old-fedcba9876543210");
  { ASSERT_TRUE(AtomicFolder::create(target, true, "marker").ok()); }
  EXPECT_EQ(read_text(target / "marker"), "old");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(AtomicFolder, IsReplacedInTwoStepsWhereAFilesystemCannotExchange) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  for (const char* content : {"one", "two"}) {
    auto output = AtomicFolder::create(target, true, "marker");
    ASSERT_TRUE(output.ok());
    write_text(output->path() / "marker", content);
    ASSERT_TRUE(output->commit(AtomicFolder::Replace::kTwoSteps).ok());
    EXPECT_EQ(read_text(target / "marker"), content);
    EXPECT_EQ(entries(folder.path()), 1U);
  }
}

TEST(AtomicFolder, ThereIsAnOutputAtEveryMomentWhileItIsReplaced) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  std::atomic<bool> stop = false;
  std::atomic<int> missing = 0;
  std::atomic<int> looked = 0;
  std::thread reader;
  for (int i = 0; i < 200; ++i) {
    auto output = AtomicFolder::create(target, true, "marker");
    ASSERT_TRUE(output.ok());
    write_text(output->path() / "marker", "x");
    ASSERT_TRUE(output->commit().ok());
    if (i > 0) continue;
    reader = std::thread([&] {
      for (; !stop; ++looked) missing += ::access(target.c_str(), F_OK) != 0;
    });
  }
  stop = true;
  reader.join();
  EXPECT_EQ(missing, 0) << "of " << looked;
}

TEST(AtomicFolder, WhatALivingProcessWritesIsNotSwept) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  auto first = AtomicFolder::create(target, true, "marker");
  ASSERT_TRUE(first.ok());
  write_text(first->path() / "marker", "first");
  auto second = AtomicFolder::create(target, true, "marker");
  ASSERT_TRUE(second.ok());
  write_text(second->path() / "marker", "second");
  ASSERT_TRUE(second->commit().ok());
  ASSERT_TRUE(first->commit().ok());
  EXPECT_EQ(read_text(target / "marker"), "first");
  EXPECT_EQ(entries(folder.path()), 1U);
}

TEST(AtomicFolder, WhatIsNotItsOwnIsNotSwept) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "out";
  const fs::path mine = folder.path() / ".out.partial-1";
  fs::create_directory(mine);
  // Where others may rename what is ours, a name proves nothing.
  fs::permissions(folder.path(), fs::perms::all);
  { ASSERT_TRUE(AtomicFolder::create(target, true, "marker").ok()); }
  EXPECT_TRUE(fs::exists(mine));
  fs::permissions(folder.path(), fs::perms::owner_all);
  if (::geteuid() == 0) {
    ASSERT_EQ(::chown(mine.c_str(), 12345, 0), 0);
    { ASSERT_TRUE(AtomicFolder::create(target, true, "marker").ok()); }
    EXPECT_TRUE(fs::exists(mine)) << "of another user";
    ASSERT_EQ(::chown(mine.c_str(), 0, 0), 0);
  }
  { ASSERT_TRUE(AtomicFolder::create(target, true, "marker").ok()); }
  EXPECT_FALSE(fs::exists(mine));
}

// Somebody who can make files in the folder knows our number and plants what we would write to.
TEST(WriteFile, PlantedLinksAreNeitherFollowedNorInTheWay) {
  const TemporaryFolder folder;
  const fs::path precious = folder.path() / "precious";
  write_text(precious, "data");
  const fs::path path = folder.path() / "map.csv";
  const std::string planted = ".map.csv.partial-" + std::to_string(::getpid());
  fs::create_symlink(precious, folder.path() / planted);
  fs::create_symlink(precious, path);
  ASSERT_TRUE(write_file(path, "new").ok());
  EXPECT_EQ(read_text(precious), "data");
  EXPECT_EQ(read_text(path), "new");
  EXPECT_FALSE(fs::is_symlink(path));
}

TEST(AtomicFolder, APlantedFolderIsNotWrittenInto) {
  const TemporaryFolder folder;
  const TemporaryFolder theirs;
  const fs::path target = folder.path() / "out";
  fs::create_directory_symlink(theirs.path(),
                               folder.path() / (".out.partial-" + std::to_string(::getpid())));
  auto output = AtomicFolder::create(target, true, "marker");
  ASSERT_TRUE(output.ok());
  write_text(output->path() / "marker", "x");
  ASSERT_TRUE(output->commit().ok());
  EXPECT_EQ(entries(theirs.path()), 0U);
  EXPECT_FALSE(fs::is_symlink(target));
}

TEST(WriteFile, ReplacesFilesAlone) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(write_file(pipe, "x").ok());
  EXPECT_TRUE(fs::is_fifo(pipe));
  fs::create_directory(folder.path() / "folder");
  EXPECT_FALSE(write_file(folder.path() / "folder", "x").ok());
  EXPECT_EQ(entries(folder.path()), 2U);
}

TEST(WriteFile, SweepsWhatAKilledProcessLeft) {
  const TemporaryFolder folder;
  write_text(folder.path() / ".file.partial-0123456789abcdef", "half");
  write_text(folder.path() / ".other.partial-0123456789abcdef", "half");
  ASSERT_TRUE(write_file(folder.path() / "file", "x").ok());
  EXPECT_EQ(entries(folder.path()), 2U) << "the other file's stays";
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
