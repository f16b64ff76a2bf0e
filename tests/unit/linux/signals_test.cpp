#include "platform/linux/signals.h"

#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/patience.h"

namespace zenith {
namespace {

// Leaves the mask and SIGPIPE as they were, for the tests after it.
class SignalsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    pthread_sigmask(SIG_SETMASK, nullptr, &mask_);
    pipe_ = std::signal(SIGPIPE, SIG_DFL);
    ASSERT_TRUE(signals_.open(SignalRequest::kReload).ok());
  }
  void TearDown() override {
    while (signals_.wait({}).has_value()) {
    }
    std::signal(SIGPIPE, pipe_);
    pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
  }

  Signals signals_;

 private:
  sigset_t mask_ = {};
  void (*pipe_)(int) = SIG_DFL;
};

TEST_F(SignalsTest, NothingAsked) {
  EXPECT_EQ(signals_.wait({}), std::nullopt);
  EXPECT_EQ(signals_.wait({1'000'000}), std::nullopt);
}

TEST_F(SignalsTest, TellsStopFromReload) {
  kill(getpid(), SIGHUP);
  EXPECT_EQ(signals_.wait(kPatience), SignalRequest::kReload);
  kill(getpid(), SIGTERM);
  EXPECT_EQ(signals_.wait(kPatience), SignalRequest::kStop);
  kill(getpid(), SIGINT);
  EXPECT_EQ(signals_.wait(kPatience), SignalRequest::kStop);
  EXPECT_EQ(signals_.wait({}), std::nullopt);
}

TEST_F(SignalsTest, ThreadsStartedLaterHaveThemBlocked) {
  sigset_t mask = {};
  std::thread([&] { pthread_sigmask(SIG_SETMASK, nullptr, &mask); }).join();
  EXPECT_EQ(sigismember(&mask, SIGTERM), 1);
  EXPECT_EQ(sigismember(&mask, SIGINT), 1);
  EXPECT_EQ(sigismember(&mask, SIGHUP), 1);
  EXPECT_EQ(sigismember(&mask, SIGSEGV), 0);
}

// As a library's threads, which are there before main().
TEST_F(SignalsTest, AThreadThatDoesNotBlockThemHandsThemOn) {
  std::atomic<bool> ready = false;
  std::atomic<bool> done = false;
  std::thread other([&] {
    sigset_t all = {};
    sigemptyset(&all);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&all, signal);
    pthread_sigmask(SIG_UNBLOCK, &all, nullptr);
    ready = true;
    while (!done) std::this_thread::yield();
  });
  while (!ready) std::this_thread::yield();
  kill(getpid(), SIGINT);
  EXPECT_EQ(signals_.wait(kPatience), SignalRequest::kStop);
  kill(getpid(), SIGHUP);
  EXPECT_EQ(signals_.wait(kPatience), SignalRequest::kReload);
  done = true;
  other.join();
}

// What a process of its own ends with: `act` returns its exit code.
template <typename Act>
int end_of(const Act& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    sigset_t none = {};
    sigemptyset(&none);
    pthread_sigmask(SIG_SETMASK, &none, nullptr);
    for (int signal = 1; signal <= SIGRTMAX; ++signal) std::signal(signal, SIG_DFL);
    ::_exit(act());
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(Signals, WhatNobodyAskedForEndsNoProgram) {
  for (const int signal : {SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGPIPE,
                           SIGXFSZ, SIGRTMIN, SIGRTMAX}) {
    EXPECT_EQ(end_of([signal] {
                Signals signals;
                if (!signals.open().ok()) return 1;
                ::kill(::getpid(), signal);
                return signals.wait({}).has_value() ? 2 : 0;
              }),
              0)
        << strsignal(signal);
  }
  EXPECT_EQ(end_of([] {
              Signals signals;
              if (!signals.open().ok()) return 1;
              ::kill(::getpid(), SIGQUIT);
              return 0;
            }),
            128 + SIGQUIT)
      << "for whoever wants a core";
}

// Of a program in a terminal: the window is closed. nohup is there to outlive that.
TEST(Signals, HangingUpStopsAProgramInATerminalUnlessItIsIgnored) {
  for (const bool ignored : {false, true}) {
    EXPECT_EQ(end_of([ignored] {
                if (ignored) std::signal(SIGHUP, SIG_IGN);
                Signals signals;
                if (!signals.open().ok()) return 1;
                ::kill(::getpid(), SIGHUP);
                return signals.wait({}) == SignalRequest::kStop ? 7 : 0;
              }),
              ignored ? 0 : 7);
  }
}

TEST_F(SignalsTest, AReaderThatLeftDoesNotEndUs) {
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  EXPECT_EQ(write(ends[1], "x", 1), -1);  // SIGPIPE would end the process here
  close(ends[1]);
}

}  // namespace
}  // namespace zenith
