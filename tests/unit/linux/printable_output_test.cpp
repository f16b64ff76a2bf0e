#include "platform/linux/printable_output.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

// What a process of its own has printed to both streams when `print` is done.
template <typename Print>
std::string printed(const Print& print) {
  tools::TemporaryFolder folder;
  const std::string file = (folder.path() / "out").string();
  const pid_t child = ::fork();
  if (child == 0) {
    const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(fd, STDOUT_FILENO);
    ::dup2(fd, STDERR_FILENO);
    make_output_printable();
    print();
    std::fflush(stdout);
    std::fflush(stderr);
    ::_exit(0);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return tools::read_text(file);
}

TEST(PrintableOutput, NothingOnEitherStreamSteersTheTerminal) {
  EXPECT_EQ(printed([] {
              std::fprintf(stderr, "error: %s\n", "\x1b]0;owned\x07");
              std::printf("robot %s\tK\u00fcche\n", "\u202er1\u009b31m\r");
              std::puts("\x9b");
              std::cout << "\x1b" << std::endl;
              std::cerr << "\x07\n";
            }),
            "error: \\x1b]0;owned\\x07\n"
            "robot \\u202er1\\u009b31m\\x0d\tK\u00fcche\n\\x9b\n\\x1b\n\\x07\n");
}

TEST(PrintableOutput, CharactersMayComeInPieces) {
  for (const std::string text : {"\u00fc", "\u5eca", "\U0001F916", "\u202e"}) {
    const std::string whole = printed([&] { std::fwrite(text.data(), 1, text.size(), stderr); });
    EXPECT_EQ(printed([&] {
                for (const char c : text) std::fputc(c, stderr);
                std::fputc('.', stderr);
              }),
              whole + ".");
  }
  // Begun and not ended, or ended by the wrong bytes.
  EXPECT_EQ(printed([] {
              for (const char c : std::string("\xe5\x1b\xe5\xbbx\xf0\x9f\xa4\xe5\x80\x80\x80.")) {
                std::fputc(c, stderr);
              }
            }),
            "\\xe5\\x1b\\xe5\\xbbx\\xf0\\x9f\\xa4\u5000\\x80.");
}

TEST(PrintableOutput, LongTextsComeWhole) {
  std::string text;
  for (int i = 0; i < 20'000; ++i) text += "\u5eca\x1b";
  const std::string shown = printed([&] { std::fputs(text.c_str(), stdout); });
  EXPECT_EQ(shown.size(), 20'000u * 7);
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
}

TEST(PrintableOutput, OurOwnWordsForTheTerminalPass) {
  EXPECT_EQ(printed([] { write_to_terminal("\r\x1b[K"); }), "\r\x1b[K");
}

}  // namespace
}  // namespace zenith
