// Whose sockets are believed, and who may make one where.

#include "platform/linux/local_socket.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr uid_t kMallory = 12345;
constexpr int kType = SOCK_SEQPACKET;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

// A socket made without listen_local(), as any program may.
UniqueFd listen_raw(const std::string& path, int backlog, int type = kType) {
  UniqueFd fd(::socket(AF_UNIX, type | SOCK_CLOEXEC, 0));
  const sockaddr_un address = address_of(path);
  EXPECT_EQ(::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(::listen(fd.get(), backlog), 0);
  return fd;
}

ino_t inode_of(const std::string& path) {
  struct stat file = {};
  return ::lstat(path.c_str(), &file) == 0 ? file.st_ino : 0;
}

class LocalSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
    for (const char* name : {"RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"}) ::unsetenv(name);
  }
  void TearDown() override { ASSERT_EQ(::seteuid(::getuid()), 0); }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  tools::TemporaryFolder folder_;
  const std::string path_ = path("t.sock");
};

#define NEEDS_ROOT() \
  if (::geteuid() != 0) GTEST_SKIP() << "SKIPPED: only root can act as another user"

// --- where ---------------------------------------------------------------------------------------

TEST_F(LocalSocketTest, NoPathIsWhereAnybodyMayMakeAFile) {
  for (const std::string& tried : runtime_paths("t.sock")) EXPECT_THAT(tried, StartsWith("/run/"));
  EXPECT_EQ(runtime_paths("/abs/t.sock"), std::vector<std::string>{"/abs/t.sock"});
  ::setenv("XDG_RUNTIME_DIR", path("mine").c_str(), 1);
  const std::vector<std::string> both = {path("mine") + "/t.sock", "/run/zenith/t.sock"};
  EXPECT_EQ(runtime_paths("t.sock"), both);
  ::unsetenv("XDG_RUNTIME_DIR");
}

TEST_F(LocalSocketTest, APersonWithoutAFolderIsToldWhatToSet) {
  NEEDS_ROOT();
  ASSERT_EQ(::seteuid(kMallory), 0);
  const auto made = runtime_path("t.sock");
  ASSERT_FALSE(made.ok()) << *made;
  EXPECT_THAT(made.error().message, HasSubstr("XDG_RUNTIME_DIR"));
  EXPECT_THAT(made.error().message, HasSubstr("telemetry.socket"));
  EXPECT_EQ(runtime_paths("t.sock"), std::vector<std::string>{"/run/zenith/t.sock"});
}

// --- whose socket is believed --------------------------------------------------------------------

TEST_F(LocalSocketTest, OnesOwnDaemonIsBelieved) {
  const auto listener = listen_local(path_, kType, 0600, 4);
  ASSERT_TRUE(listener.ok()) << listener.error().message;
  const LocalConnection connection = connect_local(path_, kType);
  EXPECT_TRUE(connection.is_open()) << connection.why;
  EXPECT_EQ(connection.pid, ::getpid());
}

TEST_F(LocalSocketTest, ASocketOfAnotherUserIsRefusedAndNamed) {
  NEEDS_ROOT();
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0777), 0);
  ASSERT_EQ(::seteuid(kMallory), 0);
  const UniqueFd planted = listen_raw(path_, 4);
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  const LocalConnection connection = connect_local(path_, kType);
  EXPECT_FALSE(connection.is_open());
  EXPECT_EQ(connection.error, EPERM);
  EXPECT_FALSE(connection.absent());
  EXPECT_THAT(connection.why, HasSubstr("12345"));
  EXPECT_THAT(connection.why, HasSubstr("root"));
}

TEST_F(LocalSocketTest, AFolderOfAnotherUserIsNotLookedInto) {
  NEEDS_ROOT();
  const auto listener = listen_local(path_, kType, 0600, 4);
  ASSERT_TRUE(listener.ok());
  ASSERT_EQ(::chown(folder_.path().c_str(), kMallory, 0), 0);
  const LocalConnection connection = connect_local(path_, kType);
  EXPECT_EQ(connection.error, EPERM);
  EXPECT_THAT(connection.why, HasSubstr("12345"));
}

TEST_F(LocalSocketTest, AFolderThatOthersMayWriteToIsNotLookedInto) {
  const auto listener = listen_local(path_, kType, 0600, 4);
  ASSERT_TRUE(listener.ok());
  for (const mode_t mode : {0757, 0775, 01777}) {  // the last one: as /tmp
    ASSERT_EQ(::chmod(folder_.path().c_str(), mode), 0);
    const LocalConnection connection = connect_local(path_, kType);
    EXPECT_EQ(connection.error, EPERM) << std::oct << mode;
    EXPECT_THAT(connection.why, HasSubstr("chmod go-w"));
  }
}

TEST_F(LocalSocketTest, NobodyThereIsNoProblemOfTrust) {
  EXPECT_TRUE(connect_local(path_, kType).absent());
  EXPECT_TRUE(connect_local("/no/such/folder/t.sock", kType).absent());
  EXPECT_EQ(connect_local(std::string(200, 'x'), kType).error, ENAMETOOLONG);
  EXPECT_EQ(connect_local("", kType).error, ENAMETOOLONG);
}

// In a child that sees a list of users of its own.
TEST_F(LocalSocketTest, TheServicesUserIsBelievedByItsName) {
  NEEDS_ROOT();
  tools::write_text(path("passwd"), "root:x:0:0::/root:/bin/sh\nzenith:x:" +
                                        std::to_string(kMallory) + ":12345::/:/usr/sbin/nologin\n");
  ASSERT_EQ(::chown(folder_.path().c_str(), kMallory, 0), 0);
  ASSERT_EQ(::seteuid(kMallory), 0);
  const UniqueFd daemon = listen_raw(path_, 4);
  ASSERT_EQ(::seteuid(0), 0);
  EXPECT_FALSE(connect_local(path_, kType).is_open()) << "without that name it is a stranger";
  constexpr int kNoNamespace = 77;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const bool seen =
        ::unshare(CLONE_NEWNS) == 0 &&
        ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
        ::mount(path("passwd").c_str(), "/etc/passwd", nullptr, MS_BIND, nullptr) == 0;
    if (!seen) ::_exit(kNoNamespace);
    ::_exit(connect_local(path_, kType).is_open() ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  if (WEXITSTATUS(status) == kNoNamespace) GTEST_SKIP() << "SKIPPED: no namespace of its own";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// --- listening -----------------------------------------------------------------------------------

TEST_F(LocalSocketTest, ALivingDaemonWithAFullQueueIsLeftAlone) {
  const UniqueFd living = listen_raw(path_, 1);
  std::vector<UniqueFd> waiting;
  for (int i = 0; i < 100; ++i) {
    LocalConnection connection = connect_local(path_, kType);
    if (connection.error == EAGAIN) break;
    waiting.push_back(std::move(connection.fd));
  }
  ASSERT_EQ(connect_local(path_, kType).error, EAGAIN);
  const ino_t before = inode_of(path_);
  const auto second = listen_local(path_, kType, 0600, 4);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("another program listens"));
  EXPECT_EQ(inode_of(path_), before);
}

TEST_F(LocalSocketTest, ADaemonOfAnotherTypeOrRightsIsLeftAlone) {
  const UniqueFd living = listen_raw(path_, 1, SOCK_STREAM);
  const ino_t before = inode_of(path_);
  EXPECT_FALSE(listen_local(path_, kType, 0600, 4).ok());
  EXPECT_EQ(inode_of(path_), before);
  tools::write_text(path("file"), "mine");
  EXPECT_FALSE(listen_local(path("file"), kType, 0600, 4).ok());
  EXPECT_EQ(tools::read_text(path("file")), "mine");
}

TEST_F(LocalSocketTest, OfThoseThatBeginAtTheSameTimeOneWins) {
  constexpr int kRounds = 100;
  constexpr int kDaemons = 4;
  for (int round = 0; round < kRounds; ++round) {
    listen_raw(path_, 1).reset();  // left behind
    std::atomic<int> ready = 0;
    std::atomic<int> winners = 0;
    std::atomic<int> done = 0;
    std::vector<std::thread> daemons;
    for (int i = 0; i < kDaemons; ++i) {
      daemons.emplace_back([&] {
        ++ready;
        while (ready < kDaemons) std::this_thread::yield();
        const auto listener = listen_local(path_, kType, 0600, 4);
        winners += listener.ok();
        ++done;
        while (done < kDaemons) std::this_thread::yield();
      });
    }
    for (std::thread& daemon : daemons) daemon.join();
    ASSERT_EQ(winners, 1) << round;
  }
  EXPECT_EQ(tools::entries(folder_.path()), 0u) << "neither sockets nor locks stay";
}

TEST_F(LocalSocketTest, TheFileHasTheRightsThatWereAskedForWhateverTheMask) {
  for (const mode_t mask : {0, 022, 077}) {
    const mode_t before = ::umask(mask);
    const auto listener = listen_local(path_, kType, 0660, 4);
    ::umask(before);
    ASSERT_TRUE(listener.ok());
    struct stat file = {};
    ASSERT_EQ(::stat(path_.c_str(), &file), 0);
    EXPECT_EQ(file.st_mode & 07777, 0660u) << std::oct << mask;
  }
}

TEST_F(LocalSocketTest, WhereOthersCouldExchangeTheSocketNoneIsMade) {
  for (const mode_t mode : {0777, 01777, 0770}) {
    ASSERT_EQ(::chmod(folder_.path().c_str(), mode), 0);
    const auto listener = listen_local(path_, kType, 0600, 4);
    ASSERT_FALSE(listener.ok()) << std::oct << mode;
    EXPECT_THAT(listener.error().message, HasSubstr("chmod go-w"));
  }
  EXPECT_EQ(tools::entries(folder_.path()), 0u);
}

TEST_F(LocalSocketTest, AtItsEndItRemovesItsOwnFileAlone) {
  auto listener = listen_local(path_, kType, 0600, 4);
  ASSERT_TRUE(listener.ok());
  fs::remove(path_);
  tools::write_text(path_, "of somebody else");
  listener->close();
  EXPECT_EQ(tools::read_text(path_), "of somebody else");
  EXPECT_EQ(tools::entries(folder_.path()), 1u);
}

}  // namespace
}  // namespace zenith
