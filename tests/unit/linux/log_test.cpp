#include "platform/linux/log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/clock.h"
#include "platform/linux/unique_fd.h"

namespace zenith {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::SizeIs;

// A log that writes into a pipe, whose other end the test reads.
class LogTest : public ::testing::Test {
 protected:
  void SetUp() override { make(LogStyle::kJournal); }

  void make(LogStyle style) {
    int ends[2] = {};
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    out_.reset(ends[0]);
    in_.reset(ends[1]);
    fcntl(out_.get(), F_SETFL, O_NONBLOCK);
    log_ = std::make_unique<Log>(in_.get(), style);
  }
  std::string text() {
    std::string all;
    std::array<char, 4096> part;
    ssize_t count = 0;
    while ((count = read(out_.get(), part.data(), part.size())) > 0) {
      all.append(part.data(), static_cast<std::size_t>(count));
    }
    return all;
  }
  std::vector<std::string> lines() {
    std::vector<std::string> list;
    std::string all = text();
    for (std::size_t end = 0; (end = all.find('\n')) != std::string::npos; all.erase(0, end + 1)) {
      list.push_back(all.substr(0, end));
    }
    EXPECT_EQ(all, "");
    return list;
  }

  UniqueFd out_;
  UniqueFd in_;
  std::unique_ptr<Log> log_;
};

TEST_F(LogTest, LinesBearTheirPriorityForTheJournal) {
  log_->write(LogLevel::kError, "camera %s lost", "/dev/video0");
  log_->write(LogLevel::kWarning, "%d frames late", 3);
  log_->write(LogLevel::kDebug, "not this");
  EXPECT_THAT(lines(), IsEmpty()) << "only drain() writes";
  EXPECT_EQ(log_->drain(monotonic_now()), 2u);
  EXPECT_THAT(lines(), ElementsAre("<3>camera /dev/video0 lost", "<4>3 frames late"));
  EXPECT_EQ(log_->drain(monotonic_now()), 0u);
}

TEST_F(LogTest, APersonSeesTimeAndWords) {
  make(LogStyle::kPerson);
  log_->write(LogLevel::kWarning, "low light");
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre(MatchesRegex("[-0-9]+ [:0-9]+\\.[0-9]+ warning: low light")));
}

TEST_F(LogTest, TheLevelCanBeChanged) {
  log_->set_level(LogLevel::kDebug);
  log_->write(LogLevel::kDebug, "seen");
  log_->set_level(LogLevel::kError);
  log_->write(LogLevel::kWarning, "unseen");
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre("<7>seen"));
}

TEST_F(LogTest, LongTextsAreCutAndMarked) {
  log_->write(LogLevel::kInfo, "%s", std::string(Log::kTextBytes - 1, 'a').c_str());
  log_->write(LogLevel::kInfo, "%s", std::string(Log::kTextBytes, 'b').c_str());
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre("<6>" + std::string(Log::kTextBytes - 1, 'a'),
                                   "<6>" + std::string(Log::kTextBytes - 4, 'b') + "..."));
}

TEST_F(LogTest, CutsBetweenCharactersOnly) {
  std::string text(Log::kTextBytes - 5, 'a');
  text += "\u00e4\u00e4\u00e4\u00e4";
  log_->write(LogLevel::kInfo, "%s", text.c_str());
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre("<6>" + std::string(Log::kTextBytes - 5, 'a') + "..."));
}

TEST_F(LogTest, OneMessageStaysOneLine) {
  log_->write(LogLevel::kInfo, "name: %s", "r1\n<0>forged\t\x1b[31m");
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre("<6>name: r1\\x0a<0>forged\\x09\\x1b[31m"));
}

TEST_F(LogTest, AttacksOnTheTerminalAreShownAsEscapes) {
  log_->write(LogLevel::kInfo, "%s", "\u009b31m \u202etxt.exe \x9b\xff");
  log_->drain(monotonic_now());
  EXPECT_THAT(lines(), ElementsAre("<6>\\u009b31m \\u202etxt.exe \\x9b\\xff"));
}

TEST_F(LogTest, EscapesAreCutWhole) {
  for (std::size_t start = 0; start < 8; ++start) {
    log_->write(LogLevel::kInfo, "%s%s", std::string(start, 'a').c_str(),
                std::string(Log::kTextBytes, '\x1b').c_str());
  }
  log_->drain(monotonic_now());
  for (const std::string& line : lines()) {
    EXPECT_THAT(line, MatchesRegex("<6>a*(\\\\x1b)+[.][.][.]"));
    EXPECT_LT(line.size(), Log::kTextBytes + 3);
  }
}

TEST_F(LogTest, AFullQueueCountsAndTells) {
  // One site each, so that the rate limit lets them pass.
  static const std::vector<std::string> kFormats = [] {
    std::vector<std::string> formats;
    for (std::size_t i = 0; i < Log::kQueued + 5; ++i) formats.push_back("x" + std::to_string(i));
    return formats;
  }();
  const auto write = [this](const char* format, ...) {
    va_list none;
    va_start(none, format);
    log_->write(LogLevel::kInfo, monotonic_now(), {}, format, none);
    va_end(none);
  };
  for (const std::string& format : kFormats) write(format.c_str());
  EXPECT_EQ(log_->counters().lost, 5u);
  EXPECT_EQ(log_->drain(monotonic_now()), Log::kQueued + 1);
  const std::vector<std::string> found = lines();
  ASSERT_THAT(found, SizeIs(Log::kQueued + 1));
  EXPECT_THAT(found.back(), HasSubstr("<4>5 log lines were lost"));
  EXPECT_EQ(log_->drain(monotonic_now()), 0u) << "told once";
}

class LogRateTest : public LogTest {
 protected:
  void repeat(int count, Time now) {
    for (int i = 0; i < count; ++i) at(now, "frame %d late", i);
  }
  void at(Time now, const char* format, ...) __attribute__((format(printf, 3, 4))) {
    va_list arguments;
    va_start(arguments, format);
    log_->write(LogLevel::kWarning, now, {}, format, arguments);
    va_end(arguments);
  }
  static constexpr Time kStart = {1'000'000'000'000};
  static constexpr int kBurst = static_cast<int>(Log::kBurst);
};

TEST_F(LogRateTest, ARepeatedLineIsLeftOutAndToldWithACount) {
  repeat(kBurst + 7, kStart);
  at(kStart, "another site");
  EXPECT_EQ(log_->drain(kStart), Log::kBurst + 1);
  EXPECT_EQ(log_->counters().suppressed, 7u);
  EXPECT_THAT(lines(), SizeIs(Log::kBurst + 1));
  EXPECT_EQ(log_->drain(kStart + Duration{Log::kWindow.ns - 1}), 0u);
  EXPECT_EQ(log_->drain(kStart + Log::kWindow), 1u);
  EXPECT_THAT(lines(), ElementsAre("<4>7 more lines like this were left out: frame %d late"));
  EXPECT_EQ(log_->drain(kStart + Log::kWindow), 0u);
}

TEST_F(LogRateTest, TheNextWindowBeginsAnewAndForgetsNothing) {
  repeat(kBurst + 7, kStart);
  log_->drain(kStart);
  lines();
  repeat(kBurst + 1, kStart + Log::kWindow);
  EXPECT_EQ(log_->drain(kStart + Log::kWindow), Log::kBurst + 1);
  EXPECT_THAT(lines().back(), HasSubstr("<4>7 more lines"));
  log_->drain(kStart + Log::kWindow + Log::kWindow);
  EXPECT_THAT(lines(), ElementsAre(HasSubstr("<4>1 more lines")));
}

// A file with many mistakes: each of them is told.
TEST_F(LogRateTest, AReportIsToldWhole) {
  std::string text = "the file is wrong:";
  for (int i = 1; i <= 3 * kBurst; ++i) text += "\nfile:" + std::to_string(i) + ": unknown key";
  log_->write_report(LogLevel::kError, kStart, LogFields("configuration-wrong"), text);
  log_->drain(kStart);
  std::vector<std::string> found = lines();
  ASSERT_THAT(found, SizeIs(3 * kBurst + 1));
  EXPECT_EQ(found.front(), "<3>the file is wrong:");
  EXPECT_EQ(found.back(), "<3>file:30: unknown key");

  // Another one right after it is told too; so is the same one again, kBurst times.
  log_->write_report(LogLevel::kError, kStart, {}, text + "\nfile:31: and another one");
  for (int i = 0; i < kBurst + 2; ++i) {
    log_->write_report(LogLevel::kError, kStart, {}, text);
    log_->drain(kStart);
  }
  EXPECT_THAT(lines(), SizeIs(3 * kBurst + 2 + (kBurst - 1) * (3 * kBurst + 1)));
  EXPECT_EQ(log_->drain(kStart + Log::kWindow), 1u);
  EXPECT_THAT(lines(), ElementsAre("<3>3 more lines like this were left out: the file is wrong:"));
  log_->write_report(LogLevel::kError, kStart + Log::kWindow, {}, text);
  log_->drain(kStart + Log::kWindow);
  EXPECT_THAT(lines(), SizeIs(3 * kBurst + 1));
}

TEST_F(LogRateTest, AReportIsBoundedAndItsLongLinesAreBroken) {
  const std::string word(100, 'w');
  log_->write_report(LogLevel::kInfo, kStart, {},
                     word + " " + word + " " + word + "\n" + std::string(500, 'x'));
  log_->drain(kStart);
  EXPECT_THAT(lines(), ElementsAre("<6>" + word + " " + word, "<6>" + word,
                                   "<6>" + std::string(Log::kTextBytes - 1, 'x'),
                                   "<6>" + std::string(Log::kTextBytes - 1, 'x'),
                                   "<6>" + std::string(500 - 2 * (Log::kTextBytes - 1), 'x')));
  std::string long_text = "0";
  for (std::size_t i = 1; i < Log::kReportLines + 7; ++i) long_text += "\n" + std::to_string(i);
  log_->write_report(LogLevel::kInfo, kStart, {}, long_text);
  log_->drain(kStart);
  const std::vector<std::string> found = lines();
  ASSERT_THAT(found, SizeIs(Log::kReportLines + 1));
  EXPECT_EQ(found.back(), "<6>and 7 further lines");
  EXPECT_EQ(log_->counters().lost, 0u);
}

TEST_F(LogRateTest, EverNewReportsAreLeftOutAtSomePoint) {
  for (std::size_t i = 0; i < Log::kReports + 5; ++i) {
    log_->write_report(LogLevel::kInfo, kStart, {}, "error number " + std::to_string(i));
  }
  log_->drain(kStart);
  const std::vector<std::string> found = lines();
  ASSERT_THAT(found, SizeIs(Log::kReports + 1));
  EXPECT_THAT(found.back(), HasSubstr("5 more lines like this were left out"));
}

TEST_F(LogTest, AReaderThatDoesNotReadHoldsNothingUp) {
  // Fill the pipe until it takes no more.
  fcntl(in_.get(), F_SETFL, O_NONBLOCK);
  const std::string filler(4096, '.');
  while (write(in_.get(), filler.data(), filler.size()) > 0) {
  }
  fcntl(in_.get(), F_SETFL, 0);
  log_->write(LogLevel::kInfo, "one");
  log_->write(LogLevel::kInfo, "two");
  EXPECT_EQ(log_->drain(monotonic_now()), 0u);
  EXPECT_EQ(log_->counters().not_written, 2u);
  text();
  log_->write(LogLevel::kInfo, "three");
  EXPECT_EQ(log_->drain(monotonic_now()), 1u);
  EXPECT_THAT(lines(), ElementsAre("<6>three"));
}

TEST_F(LogRateTest, ThreadsMayLogAtTheSameTime) {
  constexpr int kThreads = 4;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([this, t] {
      for (int i = 0; i < 200; ++i) at(kStart, "thread %d line %d", t, i);
    });
  }
  std::size_t written = 0;
  for (int i = 0; i < 50; ++i) {
    written += log_->drain(kStart);
    std::this_thread::yield();
  }
  for (std::thread& thread : threads) thread.join();
  written += log_->drain(kStart);
  EXPECT_EQ(lines().size(), written);
  const LogCounters counters = log_->counters();
  EXPECT_EQ(counters.suppressed + counters.lost + written, kThreads * 200u);
}

TEST_F(LogTest, KnowsTheJournalByItsStream) {
  struct stat file = {};
  ASSERT_EQ(fstat(in_.get(), &file), 0);
  const std::string own = std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino);
  EXPECT_TRUE(is_journal(in_.get(), own.c_str()));
  EXPECT_FALSE(is_journal(in_.get(), (own + "0").c_str()));
  EXPECT_FALSE(is_journal(in_.get(), nullptr));
  EXPECT_FALSE(is_journal(-1, own.c_str()));
}

}  // namespace
}  // namespace zenith
