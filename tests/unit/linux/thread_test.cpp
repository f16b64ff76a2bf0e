#include "platform/linux/thread.h"

#include <pthread.h>
#include <sched.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/linux/without_rights.h"

namespace zenith {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Where the calling thread finds itself.
struct Self {
  std::size_t stack_bytes = 0;
  std::string name;
  int policy = -1;
  int priority = -1;
  cpu_set_t cpus;

  Self() {
    pthread_attr_t attributes;
    pthread_getattr_np(pthread_self(), &attributes);
    pthread_attr_getstacksize(&attributes, &stack_bytes);
    pthread_attr_destroy(&attributes);
    std::array<char, 16> text = {};
    pthread_getname_np(pthread_self(), text.data(), text.size());
    name = text.data();
    sched_param param = {};
    pthread_getschedparam(pthread_self(), &policy, &param);
    priority = param.sched_priority;
    CPU_ZERO(&cpus);
    pthread_getaffinity_np(pthread_self(), sizeof(cpus), &cpus);
  }
};

TEST(Thread, HasTheNameAndStackThatWereAsked) {
  Report report;
  Self self;
  Thread thread;
  ThreadOptions options;
  options.name = "fifteen_letters";
  options.stack_bytes = std::size_t{640} * 1024;
  ASSERT_TRUE(thread
                  .start(
                      options, [&] { self = Self(); }, report)
                  .ok());
  EXPECT_TRUE(thread.running());
  thread.join();
  EXPECT_FALSE(thread.running());
  EXPECT_EQ(self.name, "fifteen_letters");
  EXPECT_EQ(self.stack_bytes, options.stack_bytes);
  EXPECT_EQ(self.policy, SCHED_OTHER);
  EXPECT_THAT(report, IsEmpty());
}

TEST(Thread, RunsOnTheCpuThatWasAsked) {
  unsigned cpu = 0;
  const Self here;
  while (cpu < 64 && !CPU_ISSET(cpu, &here.cpus)) ++cpu;
  ASSERT_LT(cpu, 64u);
  Report report;
  Self self;
  Thread thread;
  ThreadOptions options;
  options.name = "pinned";
  options.cpus = std::uint64_t{1} << cpu;
  ASSERT_TRUE(thread
                  .start(
                      options, [&] { self = Self(); }, report)
                  .ok());
  thread.join();
  EXPECT_EQ(CPU_COUNT(&self.cpus), 1);
  EXPECT_TRUE(CPU_ISSET(cpu, &self.cpus));
  EXPECT_THAT(report, IsEmpty());
}

TEST(Thread, CpusThatDoNotExistAreToldAndItRuns) {
  Report report;
  bool ran = false;
  Thread thread;
  ThreadOptions options;
  options.name = "nowhere";
  options.cpus = std::uint64_t{1} << 63;
  ASSERT_TRUE(thread
                  .start(
                      options, [&] { ran = true; }, report)
                  .ok());
  thread.join();
  EXPECT_TRUE(ran);
  EXPECT_THAT(report, ElementsAre(AllOf(HasSubstr("nowhere"), HasSubstr("EINVAL"))));
}

TEST(Thread, TakesItsPriorityOrTellsAndRunsWithout) {
  Report report;
  Self self;
  Thread thread;
  ThreadOptions options;
  options.name = "fifo";
  options.fifo_priority = 7;
  ASSERT_TRUE(thread
                  .start(
                      options, [&] { self = Self(); }, report)
                  .ok());
  thread.join();
  if (report.empty()) {
    EXPECT_EQ(self.policy, SCHED_FIFO);
    EXPECT_EQ(self.priority, 7);
  } else {
    EXPECT_EQ(self.policy, SCHED_OTHER);
  }
}

void start_fifo_without_rights() {
  Report report;
  int policy = -1;
  if (!give_up_rights()) std::exit(2);
  ThreadOptions options;
  options.name = "fifo";
  options.fifo_priority = 7;
  Thread thread;
  if (!thread
           .start(
               options, [&] { policy = Self().policy; }, report)
           .ok())
    std::exit(3);
  thread.join();
  std::fprintf(stderr, "%s\n", report.empty() ? "no report" : report[0].c_str());
  std::exit(policy == SCHED_OTHER && report.size() == 1 ? 0 : 1);
}

TEST(ThreadDeathTest, ARefusedPriorityIsToldAndItRuns) {
  EXPECT_EXIT(start_fifo_without_rights(), ::testing::ExitedWithCode(0),
              "SCHED_FIFO 7: .*EPERM.*LimitRTPRIO=7");
}

TEST(Thread, AStackThatCannotBeIsAnError) {
  Report report;
  Thread thread;
  ThreadOptions options;
  options.name = "tiny";
  options.stack_bytes = 100;
  const Status status = thread.start(
      options, [] {}, report);
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, AllOf(HasSubstr("tiny"), HasSubstr("at least")));
  EXPECT_FALSE(thread.running());
}

TEST(Thread, AStackLargerThanTheMemoryIsAnError) {
  Report report;
  Thread thread;
  ThreadOptions options;
  options.name = "vast";
  options.stack_bytes = std::size_t{1} << 50;
  EXPECT_FALSE(thread
                   .start(
                       options, [] {}, report)
                   .ok());
}

TEST(Thread, StartsAgainAfterJoin) {
  Report report;
  int runs = 0;
  Thread thread;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(thread
                    .start(
                        {.name = "again"}, [&] { ++runs; }, report)
                    .ok());
    thread.join();
  }
  EXPECT_EQ(runs, 3);
}

}  // namespace
}  // namespace zenith
