// hil-fill, in a guest: takes all memory, until the kernel kills it, before any other process.

#include <sys/mman.h>

#include <cstdio>
#include <cstring>
#include <fstream>

int main() {
  std::ofstream("/proc/self/oom_score_adj") << 1000 << std::endl;
  constexpr std::size_t kBlock = std::size_t{16} << 20;
  for (;;) {
    void* block =
        ::mmap(nullptr, kBlock, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) break;
    std::memset(block, 1, kBlock);
  }
  std::fprintf(stderr, "hil-fill: the kernel gives no more memory, but did not kill\n");
  return 1;
}
