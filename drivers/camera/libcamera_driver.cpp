#include "drivers/camera/libcamera_driver.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string>

namespace zenith {
namespace {

constexpr const char* kModule = "zenith-libcamera.so";
constexpr const char* kMake = "zenith_make_libcamera_camera";

std::string last_error() {
  const char* text = ::dlerror();
  return text != nullptr ? text : "no reason given";
}

}  // namespace

Result<std::unique_ptr<Camera>> make_libcamera_camera(const V4l2Settings& settings) {
  // What libcamera itself writes to stderr: nothing for every stream that it starts, no colours.
  constexpr int kUnlessSet = 0;
  ::setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", kUnlessSet);
  ::setenv("LIBCAMERA_LOG_NO_COLOR", "1", kUnlessSet);
  void* module = ::dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    return Error{
        "the libcamera driver is a module that cannot be loaded here (" + last_error() +
        "); it is built where libcamera-dev is installed: install that and build again, or "
        "use the V4L2 driver"};
  }
  using Make = Camera* (*)(const V4l2Settings*);
  const auto make = reinterpret_cast<Make>(::dlsym(module, kMake));
  if (make == nullptr) {
    return Error{std::string(kModule) + " is of another build: " + last_error() +
                 "; install it anew"};
  }
  return std::unique_ptr<Camera>(make(&settings));
}

}  // namespace zenith
