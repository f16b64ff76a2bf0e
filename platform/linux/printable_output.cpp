#include "platform/linux/printable_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iostream>

#include <ext/stdio_sync_filebuf.h>

#include "platform/base/printable.h"

namespace zenith {
namespace {

// Where a stream's bytes go. Lives as long as the program.
struct Output {
  int fd;
  // The beginning of a character whose rest comes with the next write.
  std::array<char, 4> begun = {};
  std::size_t begun_size = 0;
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool write_printable_to(int fd, std::string_view text) {
  std::array<char, 4096> shown;
  while (!text.empty()) {
    const PrintableSize size = write_printable(text, shown, LineEnds::kKeep);
    if (!write_all(fd, {shown.data(), size.written})) return false;
    text.remove_prefix(size.read);
  }
  return true;
}

// The bytes at the end that may be the beginning of a character: at most three.
std::size_t begun_at_end(std::string_view text) {
  for (std::size_t size = 1; size < 4 && size <= text.size(); ++size) {
    const auto byte = static_cast<unsigned char>(text[text.size() - size]);
    if ((byte & 0xc0U) == 0x80U) continue;  // not a first byte: look further
    const std::size_t needs = byte >= 0xf0 ? 4 : byte >= 0xe0 ? 3 : byte >= 0xc2 ? 2 : 1;
    return needs > size ? size : 0;
  }
  return 0;
}

// As fopencookie() wants it: the bytes taken, 0 after an error.
ssize_t write_cookie(void* cookie, const char* bytes, std::size_t size) {
  Output& out = *static_cast<Output*>(cookie);
  std::string_view text(bytes, size);
  // A begun character gets the bytes that continue it; what they make is shown by itself.
  while (out.begun_size > 0 && !text.empty()) {
    const bool continues = (static_cast<unsigned char>(text[0]) & 0xc0U) == 0x80U;
    if (continues) {
      out.begun[out.begun_size++] = text[0];
      text.remove_prefix(1);
    }
    const std::string_view begun(out.begun.data(), out.begun_size);
    if (continues && begun_at_end(begun) == begun.size()) continue;
    out.begun_size = 0;
    if (!write_printable_to(out.fd, begun)) return 0;
  }
  const std::size_t begun = begun_at_end(text);
  if (!write_printable_to(out.fd, text.substr(0, text.size() - begun))) return 0;
  if (begun > 0) out.begun_size = text.substr(text.size() - begun).copy(out.begun.data(), begun);
  return static_cast<ssize_t>(size);
}

// The stream itself when there is no memory for another one.
std::FILE* printable_stream(std::FILE* stream, Output& out, int buffering) {
  cookie_io_functions_t functions = {};
  functions.write = write_cookie;
  std::FILE* made = ::fopencookie(&out, "w", functions);
  if (made == nullptr) return stream;
  std::fflush(stream);
  std::setvbuf(made, nullptr, buffering, BUFSIZ);
  return made;
}

// The lowest free number is given: in this order each gets its own. Not closed by exec(): a child
// would have the same trouble.
void take_standard_numbers() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF) (void)::open("/", O_PATH);
  }
}

}  // namespace

void make_output_printable() {
  take_standard_numbers();
  static Output out = {STDOUT_FILENO};
  static Output errors = {STDERR_FILENO};
  stdout = printable_stream(stdout, out, ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF);
  stderr = printable_stream(stderr, errors, _IONBF);
  // C++'s streams keep the old ones. These live until the last word at the exit is out.
  using Buffer = __gnu_cxx::stdio_sync_filebuf<char>;
  static Buffer& to_output = *new Buffer(stdout);
  static Buffer& to_errors = *new Buffer(stderr);
  std::cout.rdbuf(&to_output);
  std::cerr.rdbuf(&to_errors);
  std::clog.rdbuf(&to_errors);
}

void write_to_terminal(std::string_view bytes) {
  (void)write_all(STDERR_FILENO, bytes);
}

}  // namespace zenith
