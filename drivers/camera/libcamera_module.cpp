// What zenith-libcamera.so offers: libcamera_driver.cpp loads it.

#include <pthread.h>

#include "drivers/camera/libcamera_camera.h"

namespace {

// libcamera's threads have the process's standard stacks. Of the usual 8 MiB each all would count
// against the limit of locked memory, and libcamera ends the program when it gets no thread.
void make_stacks_small() {
  constexpr std::size_t kStack = std::size_t{1024} * 1024;
  pthread_attr_t attributes;
  if (::pthread_attr_init(&attributes) != 0) return;
  ::pthread_attr_setstacksize(&attributes, kStack);
  ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) zenith::Camera* zenith_make_libcamera_camera(
    const zenith::V4l2Settings* settings) {
  make_stacks_small();
  return new zenith::LibcameraCamera(*settings);
}
