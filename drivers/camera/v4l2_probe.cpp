#include "drivers/camera/v4l2_probe.h"

#include <algorithm>

#include "drivers/camera/luma_format.h"
#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_enumerate.h"

namespace zenith {
namespace {

V4l2ProbedDevice probe_one(V4l2Io& io, const std::string& path, int width, int height) {
  V4l2ProbedDevice probed;
  probed.path = path;
  const auto device = open_v4l2_device(io, path);
  if (!device) {
    probed.problem = device.error().message;
    return probed;
  }
  auto offer = enumerate_v4l2(*device, path, width, height);
  if (!offer) {
    probed.problem = offer.error().message;
    return probed;
  }
  probed.offer = std::move(*offer);
  probed.controls = list_v4l2_controls(*device);
  const auto& formats = probed.offer.formats;
  probed.readable = probed.offer.streams &&
                    std::any_of(formats.begin(), formats.end(), [](const V4l2FormatOffer& format) {
                      return find_luma_format(format.fourcc) != nullptr;
                    });
  return probed;
}

}  // namespace

std::vector<V4l2ProbedDevice> probe_v4l2(int width, int height, V4l2Io& io) {
  std::vector<V4l2ProbedDevice> devices;
  for (const std::string& path : io.list()) devices.push_back(probe_one(io, path, width, height));
  return devices;
}

}  // namespace zenith
