#pragma once
// Eigen's own check: as long as it lives, a matrix that takes memory from the heap is a failed
// assertion. Works where all is compiled with EIGEN_RUNTIME_NO_MALLOC, and is for all threads.

#include <Eigen/Core>

namespace zenith {

class EigenNoMalloc {
 public:
  EigenNoMalloc() { Eigen::internal::set_is_malloc_allowed(false); }
  ~EigenNoMalloc() { Eigen::internal::set_is_malloc_allowed(true); }
  EigenNoMalloc(const EigenNoMalloc&) = delete;
  EigenNoMalloc& operator=(const EigenNoMalloc&) = delete;
};

}  // namespace zenith
