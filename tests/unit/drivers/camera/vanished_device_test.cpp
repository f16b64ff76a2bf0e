#include "drivers/camera/vanished_device.h"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

#include <gtest/gtest.h>

#include "platform/linux/unique_fd.h"

namespace zenith {
namespace {

constexpr int kGone = 7;
constexpr int kSubDevice = 8;  // knows another call for its capabilities

int query(int fd) {
  return fd == kGone ? -ENODEV : fd == kSubDevice ? -ENOTTY : 0;
}

TEST(VanishedDevice, IsOneThatTheKernelHasTakenAway) {
  EXPECT_FALSE(has_vanished({}, query));
  EXPECT_FALSE(has_vanished({3, kSubDevice, 4}, query)) << "other errors are those of living ones";
  EXPECT_TRUE(has_vanished({3, kSubDevice, kGone, 4}, query));
}

TEST(VanishedDevice, FilesAndOtherDevicesAreNotAsked) {
  const UniqueFd null(::open("/dev/null", O_RDWR | O_CLOEXEC));
  const UniqueFd file(::open("/proc/self/exe", O_RDONLY | O_CLOEXEC));
  const auto before = open_video_devices();
  for (const int fd : {null.get(), file.get()}) {
    EXPECT_EQ(std::count(before.begin(), before.end(), fd), 0) << fd;
  }
  EXPECT_FALSE(has_vanished(before));
  EXPECT_EQ(query_video_device(null.get()), -ENOTTY);
  EXPECT_EQ(query_video_device(-1), -EBADF);
}

TEST(VanishedDevice, AnOpenVideoDeviceIsFound) {
  const char* path = std::getenv("ZENITH_TEST_VIDEO");
  if (path == nullptr || *path == '\0') {
    GTEST_SKIP() << "no video device: ZENITH_TEST_VIDEO is not set";
  }
  const UniqueFd fd(::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC));
  ASSERT_TRUE(fd.is_open()) << path;
  const auto found = open_video_devices();
  EXPECT_EQ(std::count(found.begin(), found.end(), fd.get()), 1);
  EXPECT_FALSE(has_vanished(found));
}

}  // namespace
}  // namespace zenith
