// One program writes a folder of maps: others are refused and told who has it.

#include "platform/storage/folder_lock.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/storage/folder.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith::storage {
namespace {

namespace fs = std::filesystem;
using State = LockTry::State;
using testing::HasSubstr;

class FolderLockTest : public testing::Test {
 protected:
  const tools::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path().string();
  const fs::path file_ = temporary_.path() / "lock";
};

TEST_F(FolderLockTest, TheSecondIsRefusedAndToldWhoHasIt) {
  EXPECT_FALSE(user_of(folder_).has_value());
  {
    FolderLock first;
    ASSERT_EQ(first.take(folder_, {812, "zenithd", "ada"}).state, State::kOurs);
    EXPECT_TRUE(first.take(folder_, {812, "zenithd", "ada"}).ours()) << "it stays ours";
    FolderLock second;
    const LockTry refused = second.take(folder_, this_program("bert"));
    EXPECT_EQ(refused.state, State::kOthers);
    EXPECT_THAT(refused.why, HasSubstr("zenithd (pid 812, robot ada)"));
    const auto user = user_of(folder_);
    ASSERT_TRUE(user.has_value());
    EXPECT_EQ(user->pid, 812);
    EXPECT_EQ(user->program, "zenithd");
    EXPECT_EQ(user->robot, "ada");
    EXPECT_TRUE(fs::exists(file_));
    EXPECT_EQ(fs::status(file_).permissions(), fs::perms(0600)) << "others cannot keep it";
  }
  EXPECT_FALSE(user_of(folder_).has_value()) << "the file stays, the lock does not";
  FolderLock third;
  EXPECT_TRUE(third.take(folder_, this_program("bert")).ours());
  EXPECT_EQ(user_of(folder_)->robot, "bert");
  EXPECT_EQ(user_of(folder_)->pid, ::getpid());
}

TEST_F(FolderLockTest, IsGoneWithTheProgramThatHadIt) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    FolderLock lock;
    const char byte = lock.take(folder_, this_program("ada")).ours() ? 'y' : 'n';
    (void)!::write(ends[1], &byte, 1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ends[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'y');
  FolderLock mine;
  const LockTry refused = mine.take(folder_, this_program("bert"));
  EXPECT_EQ(refused.state, State::kOthers);
  EXPECT_THAT(refused.why, HasSubstr("(pid " + std::to_string(child) + ", robot ada)"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(mine.take(folder_, this_program("bert")).ours());
  ::close(ends[0]);
  ::close(ends[1]);
}

// The kernel locks the file and not its name.
TEST_F(FolderLockTest, AFileThatWasRemovedIsMadeAnewBeforeASecondGetsIn) {
  FolderLock first;
  ASSERT_TRUE(first.take(folder_, {812, "zenithd", "ada"}).ours());
  fs::remove(file_);
  const LockTry again = first.take(folder_, {812, "zenithd", "ada"});
  EXPECT_TRUE(again.ours());
  EXPECT_THAT(again.why, HasSubstr("removed"));
  EXPECT_EQ(first.take(folder_, {812, "zenithd", "ada"}).why, "") << "said once";
  FolderLock second;
  EXPECT_EQ(second.take(folder_, this_program("bert")).state, State::kOthers);
  EXPECT_EQ(user_of(folder_)->robot, "ada");
}

TEST_F(FolderLockTest, WhoLostItToAnotherProgramIsToldAndDoesNotGetItBack) {
  for (const bool in_use : {true, false}) {
    FolderLock first;
    ASSERT_TRUE(first.take(folder_, {812, "zenithd", "ada"}).ours());
    fs::remove(file_);
    FolderLock second;
    ASSERT_TRUE(second.take(folder_, {813, "zenithd", "bert"}).ours());
    if (!in_use) second = {};
    const LockTry lost = first.take(folder_, {812, "zenithd", "ada"});
    EXPECT_EQ(lost.state, State::kOthers);
    EXPECT_EQ(lost.why.find("robot bert") != std::string::npos, in_use) << lost.why;
    second = {};
    fs::remove(file_);
    EXPECT_EQ(first.take(folder_, {812, "zenithd", "ada"}).state, State::kOthers)
        << "what lies there may be another map";
  }
}

// Somebody who may write the folder put something else in the file's place.
TEST_F(FolderLockTest, WritesThroughNoLinkAndWaitsForNoPipe) {
  const fs::path victim = temporary_.path() / "victim";
  const auto refused = [&] {
    FolderLock lock;
    const LockTry tried = lock.take(folder_, this_program("ada"));
    EXPECT_EQ(tried.state, State::kUnknown);
    EXPECT_THAT(tried.why, HasSubstr(file_.string()));
    EXPECT_FALSE(user_of(folder_).has_value());
    fs::remove(file_);
  };
  tools::write_text(victim, "keep me");
  fs::create_symlink(victim, file_);
  refused();
  fs::create_hard_link(victim, file_);
  refused();
  EXPECT_EQ(tools::read_text(victim), "keep me");
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  refused();
  fs::create_directory(file_);
  refused();
}

TEST_F(FolderLockTest, WhatItSaysIsFitForATerminal) {
  FolderLock lock;
  ASSERT_TRUE(lock.take(folder_, {7, "zen\x1b[31mithd", "a\tb"}).ours());
  EXPECT_EQ(user_text(*user_of(folder_)), "zen\\x1b[31mithd (pid 7, robot a\\x09b)");
  // A lock whose owner has said nothing yet, or what is no text of ours.
  tools::write_text(file_, "");
  EXPECT_EQ(user_text(*user_of(folder_)), "another program");
  tools::write_text(file_, std::string(100'000, 'x'));
  EXPECT_EQ(user_text(*user_of(folder_)), "another program");
}

TEST_F(FolderLockTest, AFolderThatIsNotThereIsToldOf) {
  FolderLock lock;
  const LockTry tried = lock.take(folder_ + "/none", this_program("ada"));
  EXPECT_EQ(tried.state, State::kUnknown);
  EXPECT_THAT(tried.why, HasSubstr("No such file"));
  EXPECT_FALSE(look_at_folder(folder_ + "/none").exists);
}

TEST_F(FolderLockTest, AFolderIsLookedAtWithoutTouchingIt) {
  FolderFacts facts = look_at_folder(folder_);
  EXPECT_TRUE(facts.exists && facts.is_folder && facts.writable);
  EXPECT_FALSE(facts.owner.empty());
  EXPECT_GT(facts.free_mb, 0.0);
  EXPECT_FALSE(facts.user.has_value());
  EXPECT_FALSE(fs::exists(file_));
  FolderLock lock;
  ASSERT_TRUE(lock.take(folder_, this_program("ada")).ours());
  facts = look_at_folder(folder_);
  ASSERT_TRUE(facts.user.has_value());
  EXPECT_EQ(facts.user->robot, "ada");
  EXPECT_FALSE(look_at_folder(file_.string()).is_folder);
}

// A map written by root, such as an imported one, has to be read by the service's user.
TEST_F(FolderLockTest, FilesThatRootMakesAreTheFoldersOwners) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root";
  constexpr uid_t kSomebody = 12345;
  ASSERT_EQ(::chown(folder_.c_str(), kSomebody, kSomebody), 0);
  DiskFolder folder(folder_);
  ASSERT_TRUE(folder.lock(this_program("ada")).ours());
  ASSERT_TRUE(folder.create("map.partial").ok());
  for (const char* name : {"lock", "map.partial"}) {
    struct stat info = {};
    ASSERT_EQ(::stat((folder_ + "/" + name).c_str(), &info), 0);
    EXPECT_EQ(info.st_uid, kSomebody) << name;
    EXPECT_EQ(info.st_gid, kSomebody) << name;
  }
}

}  // namespace
}  // namespace zenith::storage
