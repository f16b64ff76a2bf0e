// A program with none of the hardening flags: what the test of the built files must find.

#undef _FORTIFY_SOURCE

#include <cstdio>
#include <cstring>

int main(int argc, char** argv) {
  char name[16] = "";
  if (argc > 1) std::strncpy(name, argv[1], sizeof name - 1);
  return std::printf("%s %d\n", name, argc) < 0 ? 1 : 0;
}
