#include "platform/linux/service_notify.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace zenith {
namespace {

using ::testing::HasSubstr;

// The service manager's end: a datagram socket, with a path or (name begins with @) without.
class Manager {
 public:
  explicit Manager(const std::string& name) {
    fd_ = UniqueFd(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0));
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    std::size_t length = offsetof(sockaddr_un, sun_path) + name.size();
    if (name[0] == '@') {
      address.sun_path[0] = '\0';
    } else {
      path_ = name;
      ++length;
      unlink(name.c_str());
    }
    bound_ =
        bind(fd_.get(), reinterpret_cast<sockaddr*>(&address), static_cast<socklen_t>(length)) == 0;
  }
  ~Manager() {
    if (!path_.empty()) unlink(path_.c_str());
  }

  bool bound() const { return bound_; }
  // The next message; empty when there is none.
  std::string next() {
    std::array<char, 1024> text;
    const ssize_t length = recv(fd_.get(), text.data(), text.size(), 0);
    return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
  }

 private:
  UniqueFd fd_;
  std::string path_;
  bool bound_ = false;
};

std::string unique_name(const std::string& prefix) {
  return prefix + "zenith_notify_" + std::to_string(getpid());
}

class ServiceNotifyTest : public ::testing::Test {
 protected:
  void SetUp() override { clear(); }
  void TearDown() override { clear(); }
  static void clear() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  static void set(const char* name, const std::string& value) { setenv(name, value.c_str(), 1); }
};

TEST_F(ServiceNotifyTest, WithoutAManagerItDoesNothing) {
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_FALSE(notify.connected());
  EXPECT_TRUE(notify.ready().ok());
  EXPECT_TRUE(notify.watchdog().ok());
  EXPECT_EQ(notify.watchdog_interval(), std::nullopt);
}

TEST_F(ServiceNotifyTest, SaysEverythingThroughAPath) {
  Manager manager(unique_name("/tmp/"));
  ASSERT_TRUE(manager.bound());
  set("NOTIFY_SOCKET", unique_name("/tmp/"));
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_TRUE(notify.connected());
  EXPECT_TRUE(notify.ready().ok());
  EXPECT_EQ(manager.next(), "READY=1");
  EXPECT_TRUE(notify.watchdog().ok());
  EXPECT_EQ(manager.next(), "WATCHDOG=1");
  EXPECT_TRUE(notify.reloading(Time{1'234'567'890}).ok());
  EXPECT_EQ(manager.next(), "RELOADING=1\nMONOTONIC_USEC=1234567");
  EXPECT_TRUE(notify.stopping().ok());
  EXPECT_EQ(manager.next(), "STOPPING=1");
  EXPECT_TRUE(notify.extend_timeout(Duration{2'500'000'000}).ok());
  EXPECT_EQ(manager.next(), "EXTEND_TIMEOUT_USEC=2500000");
  EXPECT_TRUE(notify.status("mapping,\n3 peers").ok());
  EXPECT_EQ(manager.next(), "STATUS=mapping, 3 peers");
  EXPECT_EQ(manager.next(), "");
}

TEST_F(ServiceNotifyTest, ALongStatusIsCut) {
  Manager manager(unique_name("@"));
  set("NOTIFY_SOCKET", unique_name("@"));
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_TRUE(notify.status(std::string(5000, 'x')).ok());
  EXPECT_EQ(manager.next(), "STATUS=" + std::string(200, 'x'));
}

TEST_F(ServiceNotifyTest, FindsAnAbstractSocket) {
  Manager manager(unique_name("@"));
  ASSERT_TRUE(manager.bound());
  set("NOTIFY_SOCKET", unique_name("@"));
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_TRUE(notify.ready().ok());
  EXPECT_EQ(manager.next(), "READY=1");
}

TEST_F(ServiceNotifyTest, AManagerThatDoesNotReadBlocksNobody) {
  Manager manager(unique_name("@"));
  set("NOTIFY_SOCKET", unique_name("@"));
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  bool refused = false;
  for (int i = 0; i < 100'000 && !refused; ++i) refused = !notify.watchdog().ok();
  EXPECT_TRUE(refused);
}

TEST_F(ServiceNotifyTest, SocketsThatCannotBeAreErrors) {
  for (const std::string& name :
       {std::string("relative"), std::string("/nonexistent/notify"), std::string("vsock:2:1"),
        "/" + std::string(200, 'x'), std::string("")}) {
    SCOPED_TRACE(name);
    set("NOTIFY_SOCKET", name);
    ServiceNotify notify;
    const Status status = notify.open_from_environment();
    ASSERT_FALSE(status.ok());
    EXPECT_THAT(status.error().message, HasSubstr("NOTIFY_SOCKET=" + name));
    EXPECT_FALSE(notify.connected());
    EXPECT_TRUE(notify.ready().ok());
  }
}

TEST_F(ServiceNotifyTest, TheWatchdogIsOursOnly) {
  Manager manager(unique_name("@"));
  set("NOTIFY_SOCKET", unique_name("@"));
  set("WATCHDOG_USEC", "20000000");
  ServiceNotify notify;
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_EQ(notify.watchdog_interval(), Duration::from_seconds(20));
  set("WATCHDOG_PID", std::to_string(getpid()));
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_EQ(notify.watchdog_interval(), Duration::from_seconds(20));
  set("WATCHDOG_PID", "1");
  ASSERT_TRUE(notify.open_from_environment().ok());
  EXPECT_EQ(notify.watchdog_interval(), std::nullopt);
}

TEST_F(ServiceNotifyTest, WatchdogValuesThatAreNoneAreErrors) {
  Manager manager(unique_name("@"));
  set("NOTIFY_SOCKET", unique_name("@"));
  for (const char* value : {"", "0", "-3", "12s", "99999999999999999999", "9223372036854775807"}) {
    SCOPED_TRACE(value);
    set("WATCHDOG_USEC", value);
    ServiceNotify notify;
    EXPECT_FALSE(notify.open_from_environment().ok());
  }
  set("WATCHDOG_USEC", "5");
  set("WATCHDOG_PID", "me");
  ServiceNotify notify;
  const Status status = notify.open_from_environment();
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, HasSubstr("WATCHDOG_PID"));
}

}  // namespace
}  // namespace zenith
