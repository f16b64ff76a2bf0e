#include "platform/linux/input_file.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/hostile_files.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using tools::write_text;

class InputFileTest : public testing::Test {
 protected:
  std::vector<std::string> lines_of(InputLines& lines) {
    std::vector<std::string> all;
    std::string_view line;
    while (lines.next(line)) all.emplace_back(line);
    status_ = lines.status();
    return all;
  }
  // Of a file and of a text in memory; both are the same.
  std::vector<std::string> read(const std::string& text, const LineLimits& limits) {
    InputLines in_memory(text, path_, limits);
    const auto expected = lines_of(in_memory);
    const Status told = status_;
    write_text(path_, text);
    auto file = InputLines::open(path_, limits);
    EXPECT_TRUE(file.ok());
    if (!file.ok()) return {};
    const auto found = lines_of(*file);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(status_.ok(), told.ok());
    if (!told.ok()) {
      EXPECT_EQ(status_.error().message, told.error().message);
    }
    return found;
  }

  tools::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "input").string();
  Status status_;
};

TEST_F(InputFileTest, AFileIsReadWhole) {
  for (const std::size_t size : {0, 1, 4096, 65536, 200'000}) {
    std::string text(size, 'x');
    if (size > 0) text.back() = '\0';
    write_text(path_, text);
    const auto read = read_input(path_, size);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(*read, text);
  }
}

TEST_F(InputFileTest, ALinkToAFileIsThatFile) {
  write_text(folder_.path() / "real", "text");
  std::filesystem::create_symlink("real", path_);
  EXPECT_EQ(*read_input(path_, 10), "text");
}

TEST_F(InputFileTest, WhatSaysItIsEmptyIsReadToItsEnd) {
  const auto status = read_input("/proc/self/status", 65536);
  ASSERT_TRUE(status.ok()) << status.error().message;
  EXPECT_THAT(*status, HasSubstr("VmRSS"));
  EXPECT_THAT(read_input("/proc/self/status", 100).error().message,
              HasSubstr("expected at most 100 bytes"));
}

TEST_F(InputFileTest, NothingElseIsOpened) {
  for (const Trap& trap : traps()) {
    SCOPED_TRACE(trap.kind);
    trap.lay(path_);
    EXPECT_THAT(read_input(path_, 1 << 20).error().message,
                AllOf(HasSubstr(path_), HasSubstr(trap.told)));
    EXPECT_THAT(InputLines::open(path_, {1 << 20}).error().message, HasSubstr(trap.told));
    std::filesystem::remove(path_);
  }
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(read_input(path_, 10).error().message, HasSubstr("found a socket"));
  ::close(listener);
  EXPECT_THAT(read_input(folder_.path(), 10).error().message, HasSubstr("found a folder"));
  EXPECT_THAT(read_input(path_ + ".none", 10).error().message,
              AllOf(HasSubstr("missing"), HasSubstr("ENOENT")));
}

TEST_F(InputFileTest, LinesHaveTheirEndsTakenOff) {
  const LineLimits limits = {1 << 20, 10};
  EXPECT_THAT(read("", limits), ElementsAre());
  EXPECT_THAT(read("\n", limits), ElementsAre(""));
  EXPECT_THAT(read("a\r\n\nb", limits), ElementsAre("a", "", "b"));
  EXPECT_THAT(read("0123456789\n0123456789", limits), ElementsAre("0123456789", "0123456789"));
  EXPECT_TRUE(status_.ok());
}

// Editors of some systems begin a file with a mark that says UTF-8, or write UTF-16.
TEST_F(InputFileTest, AnEditorsMarkIsPassedOverAndUtf16IsTold) {
  const LineLimits limits = {1 << 20, 40};
  EXPECT_THAT(read("\xef\xbb\xbf#a\n\xef\xbb\xbf"
                   "b\n",
                   limits),
              ElementsAre("#a",
                          "\xef\xbb\xbf"
                          "b"));
  EXPECT_EQ(*read_text_input(path_, 100),
            "#a\n\xef\xbb\xbf"
            "b\n");
  EXPECT_THAT(read("\xef\xbb\xbf", limits), ElementsAre(""));
  EXPECT_EQ(*read_text_input(path_, 100), "");
  for (const std::string& text :
       {std::string("\xff\xfe#\0a\0\n\0", 8), std::string("\xfe\xff\0#\0\n", 6)}) {
    EXPECT_THAT(read(text, limits), ElementsAre());
    EXPECT_THAT(status_.error().message, AllOf(HasSubstr(path_), HasSubstr("UTF-16")));
    EXPECT_THAT(read_text_input(path_, 100).error().message, HasSubstr("save it as UTF-8"));
  }
}

TEST_F(InputFileTest, ASecretIsReadOnlyWhereOthersCouldNot) {
  const auto refusal = [this](mode_t mode) {
    EXPECT_EQ(::chmod(path_.c_str(), mode), 0);
    const auto file = open_secret(path_);
    return file.ok() ? "" : file.error().message;
  };
  write_text(path_, "secret");
  for (const mode_t mode : {0600, 0640, 0400}) EXPECT_EQ(refusal(mode), "") << mode;
  for (const mode_t mode : {0604, 0602, 0620, 0610}) {
    EXPECT_THAT(refusal(mode), HasSubstr("chmod 600 " + path_)) << mode;
  }
  EXPECT_THAT(refusal(0644), HasSubstr("chmod 640 " + path_));
  ASSERT_EQ(refusal(0600), "");
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chown(path_.c_str(), 12345, 0), 0);
  EXPECT_THAT(open_secret(path_).error().message, HasSubstr("belongs to user 12345"));
}

TEST_F(InputFileTest, ALongLineEndsTheReading) {
  const LineLimits limits = {1 << 20, 10};
  EXPECT_THAT(read("a\n0123456789x\nb\n", limits), ElementsAre("a"));
  EXPECT_THAT(status_.error().message,
              AllOf(HasSubstr("input:2: "), HasSubstr("at most 10 bytes")));
  EXPECT_THAT(read(std::string(300'000, 'x'), limits), ElementsAre());
  EXPECT_FALSE(status_.ok());
}

TEST_F(InputFileTest, LinesReachOverThePiecesOfAFile) {
  std::string text;
  std::vector<std::string> expected;
  for (std::size_t i = 0; i < 3000; ++i) {
    expected.emplace_back(i % 97, static_cast<char>('a' + i % 26));
    text += expected.back() + '\n';
  }
  EXPECT_EQ(read(text, {1 << 20, 100}), expected);
  EXPECT_TRUE(status_.ok());
}

TEST_F(InputFileTest, AFileThatGrowsBeyondItsLimitIsTold) {
  write_text(path_, "a\n");
  auto lines = InputLines::open(path_, {100'000});
  ASSERT_TRUE(lines.ok());
  std::ofstream more(path_, std::ios::app);
  for (int i = 0; i < 100'000; ++i) more << "b\n";
  more.close();
  EXPECT_LE(lines_of(*lines).size(), 100'000u);
  EXPECT_THAT(status_.error().message, HasSubstr("grows"));
}

TEST(BytesText, SaysSizesForPeople) {
  EXPECT_EQ(bytes_text(100), "100 bytes");
  EXPECT_EQ(bytes_text(1024), "1 kB");
  EXPECT_EQ(bytes_text(1536), "1.5 kB");
  EXPECT_EQ(bytes_text(std::uint64_t{100} << 30U), "100 GB");
}

}  // namespace
}  // namespace zenith
