#include "drivers/camera/v4l2_device.h"

#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

constexpr const char* kNamePrefix = "name:";
constexpr const char* kBusPrefix = "bus:";

// The kernel's strings fill their arrays and may lack the final zero.
template <std::size_t N>
std::string text_of(const __u8 (&field)[N]) {
  const char* start = reinterpret_cast<const char*>(field);
  return {start, ::strnlen(start, N)};
}

std::string advice(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "no camera is there now; is it plugged in? 'v4l2-ctl --list-devices' lists cameras";
    case EACCES:
    case EPERM:
      return "the user must belong to the group 'video'";
    case EBUSY:
      return "another program uses it: 'fuser -v' on the device names it";
    default:
      return "is it a camera?";
  }
}

std::string list_text(const std::vector<V4l2Offer>& offers) {
  std::string text;
  for (const V4l2Offer& offer : offers) {
    text += (text.empty() ? "" : "; ") + offer.path + " '" + offer.card + "' (" + offer.bus + ")" +
            (offer.captures ? "" : " which does not capture now");
  }
  return text.empty() ? "no video device" : text;
}

std::vector<V4l2Offer> all_identities(V4l2Io& io) {
  std::vector<V4l2Offer> offers;
  for (const std::string& path : io.list()) {
    const auto device = open_v4l2_device(io, path);
    if (!device) continue;
    auto offer = read_identity(*device, path);
    if (offer) offers.push_back(std::move(*offer));
  }
  return offers;
}

}  // namespace

Result<V4l2Device> open_v4l2_device(V4l2Io& io, const std::string& path) {
  const int fd = io.open(path.c_str());
  if (fd >= 0) return V4l2Device(io, fd);
  return Error{"cannot open the camera " + path + ": " + errno_text(-fd) + "; " + advice(-fd)};
}

Result<V4l2Offer> read_identity(const V4l2Device& device, const std::string& path) {
  v4l2_capability capability = {};
  const int result = device.control(VIDIOC_QUERYCAP, &capability);
  if (result < 0) {
    return Error{path + " is no V4L2 device: " + errno_text(-result) + "; name a /dev/video*"};
  }
  const std::uint32_t caps = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                 ? capability.device_caps
                                 : capability.capabilities;
  V4l2Offer offer;
  offer.path = path;
  offer.driver = text_of(capability.driver);
  offer.card = text_of(capability.card);
  offer.bus = text_of(capability.bus_info);
  const bool single = (caps & V4L2_CAP_VIDEO_CAPTURE) != 0;
  const bool multi = (caps & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
  offer.captures = single || multi;
  offer.multiplanar = multi && !single;
  offer.streams = (caps & V4L2_CAP_STREAMING) != 0;
  offer.has_output = (caps & (V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_OUTPUT_MPLANE)) != 0;
  return offer;
}

Result<std::string> find_v4l2_device(V4l2Io& io, const std::string& device) {
  const bool by_name = device.rfind(kNamePrefix, 0) == 0;
  const bool by_bus = device.rfind(kBusPrefix, 0) == 0;
  if (!by_name && !by_bus) {
    if (!device.empty() && device[0] == '/') return device;
    return Error{"the camera '" + device + "' is not named as expected: write a path " +
                 "(\"/dev/video0\"), \"name:PART OF THE CARD'S NAME\" or \"bus:PART\""};
  }
  const std::string part = device.substr(std::strlen(by_name ? kNamePrefix : kBusPrefix));
  const std::vector<V4l2Offer> all = all_identities(io);
  std::vector<V4l2Offer> fitting;
  bool several = false;
  for (const V4l2Offer& offer : all) {
    const std::string& text = by_name ? offer.card : offer.bus;
    if (!offer.captures || part.empty() || text.find(part) == std::string::npos) continue;
    several |= !fitting.empty() && fitting.front().bus != offer.bus;
    fitting.push_back(offer);
  }
  if (fitting.empty()) {
    return Error{"no camera fits \"" + device + "\"; there is: " + list_text(all)};
  }
  if (several) {
    return Error{"several cameras fit \"" + device + "\": " + list_text(fitting) +
                 "; name one by more of its name, or by \"bus:\""};
  }
  return fitting.front().path;
}

}  // namespace zenith
