#pragma once
// What must hold, whatever the input: in every build, unlike assert().

#include <cstdio>
#include <cstdlib>

#define require(condition)                                                                \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                       \
    }                                                                                     \
  } while (false)
