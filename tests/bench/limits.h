#pragma once
// What the machine does at most of the mixes of instructions that the kernels are made of: from
// registers, without dependence between neighbours.

#include <vector>

namespace zenith::bench {

struct Limit {
  const char* name;
  int products_each;  // multiplications (with additions) in one round
  void (*run)(int rounds);
};

std::vector<Limit> limits();  // that this processor can run

}  // namespace zenith::bench
