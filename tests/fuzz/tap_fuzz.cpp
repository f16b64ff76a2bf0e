// Any bytes where a recorder expects the daemon's messages: the first byte is the message's type,
// the rest are its fields. What is read is of its kind.

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/base/printable.h"
#include "platform/config/robot_settings.h"
#include "platform/daemon/tap/wire.h"
#include "tests/fuzz/require.h"

using namespace zenith;       // NOLINT(google-build-using-namespace)
using namespace zenith::tap;  // NOLINT(google-build-using-namespace)

namespace {

void read_as_hello(std::span<const std::uint8_t> fields) {
  const auto hello = read_hello(fields);
  if (!hello) {
    require(is_printable(hello.error().message));
    return;
  }
  require(is_robot_name(hello->robot));
  require(is_interface_name(hello->can_interface));
  require(is_printable(hello->software) && is_printable(hello->devices));
  require(std::isfinite(hello->config.lens.fu_px) && hello->config.frame_rate_hz > 0.0);
  require(hello->config.lens.width_px > 0 && hello->config.lens.height_px > 0);
  require(is_printable(hello->odometry.dbc.file));
  const auto again = write_hello(*hello);
  require(read_hello(std::span(again).subspan(kHeaderBytes)).ok());
}

void read_as_can(std::span<const std::uint8_t> fields) {
  std::vector<CanFrame> frames;
  if (!read_can(fields, frames)) return;
  require(frames.size() * kCanBytes == fields.size());
  for (const CanFrame& frame : frames) require(frame.length <= 8 && frame.id <= 0x1FFFFFFF);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  if (bytes.size() >= kHeaderBytes) (void)read_header(bytes.first<kHeaderBytes>());
  if (bytes.empty()) return 0;
  const auto fields = bytes.subspan(1);
  switch (static_cast<MessageType>(bytes[0])) {
    case MessageType::kHello:
      read_as_hello(fields);
      break;
    case MessageType::kFrame: {
      std::span<const std::uint8_t> pixels;
      const auto head = read_frame(fields, pixels);
      if (!head) break;
      require(pixels.size() ==
              static_cast<std::size_t>(head->width) * static_cast<std::size_t>(head->height));
      break;
    }
    case MessageType::kCan:
      read_as_can(fields);
      break;
    case MessageType::kPose: {
      const auto pose = read_pose(fields);
      if (pose) require(std::isfinite(pose->pose.x_m + pose->pose.theta_rad));
      break;
    }
    case MessageType::kEnd: {
      const auto end = read_end(fields);
      if (end) require(is_printable(end->why));
      break;
    }
    case MessageType::kBusy:
      break;
  }
  return 0;
}
