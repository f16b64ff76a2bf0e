#include "platform/linux/wait_readable.h"

#include <poll.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "platform/linux/clock.h"
#include "platform/linux/unique_fd.h"
#include "tests/support/patience.h"

namespace zenith {
namespace {

TEST(WaitReadable, TellsWhatIsThereAtOnceAndOtherwiseWaits) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const UniqueFd reader(ends[0]);
  UniqueFd writer(ends[1]);
  const Time start = monotonic_now();
  EXPECT_EQ(wait_readable(reader.get(), {20'000'000}), 0);
  EXPECT_GE(monotonic_now() - start, Duration{20'000'000});
  EXPECT_EQ(wait_readable(reader.get(), {0}), 0);
  EXPECT_EQ(wait_readable(reader.get(), {-5}), 0);
  ASSERT_EQ(::write(writer.get(), "x", 1), 1);
  EXPECT_EQ(wait_readable(reader.get(), kPatience), POLLIN);
  writer.reset();
  EXPECT_NE(wait_readable(reader.get(), kPatience) & POLLHUP, 0);
}

TEST(WaitReadable, AClosedDescriptorIsToldAsAnEvent) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_EQ(wait_readable(ends[0], kPatience), POLLNVAL);
}

}  // namespace
}  // namespace zenith
