#pragma once
// Checks that stay in every build, where going on would read or write memory that belongs to
// something else: an index beyond a container's end, a block that is too small.
//
// Which check for what:
//
//   assert   a mistake in the program that no input can cause, and that damages no memory; it is
//            gone in the release
//   ensure   a mistake that would damage memory: one line on stderr, and the program ends; the
//            service manager starts it again, and the map comes from the disk
//   input    datagrams, files, devices, configuration, and numbers computed from them: neither of
//            the two. A value is tested, then refused or replaced, and counted
//
// One that holds costs a comparison and a branch that is not taken. No heap, no lock. Whoever ends
// by one leaves its last words in the journal.

#include <cstdio>
#include <cstdlib>

namespace zenith {

// Writes "zenith: WHAT (FILE:LINE)" to stderr and ends the program.
[[noreturn, gnu::cold, gnu::noinline]] inline void ensure_failed(const char* what, const char* file,
                                                                 int line) {
  std::fprintf(stderr, "zenith: %s (%s:%d)\n", what, file, line);
  std::abort();
}

// `what` says what was broken: a literal. File and line are the caller's.
//
//   ensure(i < size_, "FixedVector: index beyond the end");
inline void ensure(bool holds, const char* what, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
  if (holds) [[likely]]
    return;
  ensure_failed(what, file, line);
}

}  // namespace zenith
