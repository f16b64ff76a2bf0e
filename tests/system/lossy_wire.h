#pragma once
// An interface that loses a share of the frames that come in, each by chance: a small program that
// the kernel runs on each of them (XDP), for kernels without netem.

#include "platform/linux/unique_fd.h"

namespace zenith {

class LossyWire {
 public:
  // For the interface of the calling thread's network. Losses end with the object.
  LossyWire(const char* interface, double share);
  // False: the kernel does not do it, or not for us.
  bool works() const { return link_.is_open(); }

 private:
  UniqueFd program_;
  UniqueFd link_;
};

}  // namespace zenith
