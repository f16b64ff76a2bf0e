// journald's native protocol, and what the log makes of it.

#include "platform/linux/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "tests/support/journal_reader.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

TEST(JournalEntry, IsBytesAsThePageSays) {
  JournalEntry entry;
  entry.text("MESSAGE", "ready");
  entry.number("PRIORITY", 5);
  entry.text("TWO", "a\nb");
  entry.number("X_M", -0.125);
  const char expected[] = "MESSAGE=ready\nPRIORITY=5\nTWO\n\3\0\0\0\0\0\0\0a\nb\nX_M=-0.125\n";
  EXPECT_EQ(entry.bytes(), std::string_view(expected, sizeof expected - 1));
}

TEST(JournalEntry, NothingInAValueBecomesAField) {
  JournalEntry entry;
  entry.text("MESSAGE", "name\n_UID=0\nPRIORITY=0");
  entry.text("EMPTY", "");
  EXPECT_THAT(read_journal_entry(entry.bytes()),
              UnorderedElementsAre(Pair("MESSAGE", "name\n_UID=0\nPRIORITY=0"), Pair("EMPTY", "")));
}

TEST(JournalEntry, WhatDoesNotFitIsLeftOutWhole) {
  JournalEntry entry;
  entry.text("FIRST", std::string(JournalEntry::kBytes - 20, 'x'));
  entry.text("SECOND", "does not fit any more");
  entry.text("C", "fits");
  const auto fields = read_journal_entry(entry.bytes());
  EXPECT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields.at("C"), "fits");
  EXPECT_LE(entry.bytes().size(), JournalEntry::kBytes);
}

class JournalLog : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::pipe2(ends_, O_CLOEXEC | O_NONBLOCK), 0);
    log_ = std::make_unique<Log>(ends_[1], LogStyle::kJournal);
    log_->use_journal(socket_);
    log_->name_robot("anna");
  }
  void TearDown() override {
    for (const int end : ends_) ::close(end);
  }
  void say(const LogFields& fields, const char* format, ...) __attribute__((format(printf, 3, 4))) {
    va_list arguments;
    va_start(arguments, format);
    log_->write(LogLevel::kWarning, monotonic_now(), fields, format, arguments);
    va_end(arguments);
    log_->drain(monotonic_now());
  }
  std::string on_stderr() const {
    std::string text(4096, '\0');
    const ssize_t size = ::read(ends_[0], text.data(), text.size());
    return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }

  tools::TemporaryFolder folder_;
  const std::string socket_ = (folder_.path() / "socket").string();
  int ends_[2] = {};
  std::unique_ptr<Log> log_;
};

TEST_F(JournalLog, AnEventHasItsFields) {
  const JournalReader journal(socket_);
  LogFields fields("merged");
  fields.text("ZENITH_PEER", "bert\nPRIORITY=0").number("ZENITH_X_M", 1.25);
  say(fields, "merged with robot %s", "bert\nPRIORITY=0");
  EXPECT_THAT(
      journal.next(),
      UnorderedElementsAre(Pair("MESSAGE", "merged with robot bert\\x0aPRIORITY=0"),
                           Pair("PRIORITY", "4"), Pair("SYSLOG_IDENTIFIER", testing::_),
                           Pair("ZENITH_ROBOT", "anna"), Pair("ZENITH_EVENT", "merged"),
                           Pair("ZENITH_PEER", "bert\nPRIORITY=0"), Pair("ZENITH_X_M", "1.25")));
  say({}, "plain");
  EXPECT_EQ(journal.next().count("ZENITH_EVENT"), 0u);
  EXPECT_THAT(on_stderr(), IsEmpty());
  EXPECT_EQ(log_->counters().not_written, 0u);
}

TEST_F(JournalLog, WithoutAJournalLinesGoToStderrAndLaterTheyDoNot) {
  say(LogFields("ready"), "before");
  EXPECT_EQ(on_stderr(), "<4>before\n");
  const JournalReader journal(socket_);
  say(LogFields("ready"), "after");
  EXPECT_EQ(journal.next().at("MESSAGE"), "after");
  EXPECT_THAT(on_stderr(), IsEmpty());
}

// A journal that does not read holds nothing up.
TEST_F(JournalLog, WhenTheJournalIsFullLinesGoToStderr) {
  const JournalReader journal(socket_);
  std::string said;
  for (int i = 0; i < 5000 && said.empty(); ++i) {
    static const std::string filler(200, 'x');
    JournalEntry entry;
    entry.text("MESSAGE", filler);
    if (!JournalSocket(socket_).send(entry)) {
      say({}, "one more");
      said = on_stderr();
    }
  }
  EXPECT_EQ(said, "<4>one more\n");
}

}  // namespace
}  // namespace zenith
