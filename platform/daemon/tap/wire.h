#pragma once
// What the daemon tells a recorder through its tap: messages on a local stream socket.
//
//   u32 length   bytes after these five
//   u8  type     MessageType
//   ...          the message's fields
//
// Numbers are little-endian, doubles IEEE 754, texts a u32 length and bytes. Times are nanoseconds
// of CLOCK_MONOTONIC. The daemon begins with hello, or with busy when it has a recorder already.
// The recorder says nothing; when it has enough it shuts its sending side down, gets what is under
// way, and end.
//
//   hello  "ZTAP" u16 version, texts robot, software, devices; lens: u32 width height, f64 fu fv
//          cu cv k1 .. k4; mount: f64 x y z roll pitch yaw; wheels: f64 track left_scale
//          right_scale; f64 frame rate; text CAN interface; text codec; u32 n, n keys: text key, u8
//          kind, value; text DBC file's content
//   frame  i64 stamp, u64 sequence, u32 width height, width x height bytes
//   can    frames, each i64 stamp, u32 id, u8 extended, u8 length, 8 bytes
//   pose   i64 stamp, f64 x y theta
//   end    u64 frames sent, dropped, can frames sent, dropped, poses sent, dropped; text why

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/wheel_codec_config.h"
#include "platform/base/result.h"
#include "platform/base/time.h"
#include "slam/geometry.h"
#include "slam/robot.h"

namespace zenith::tap {

inline constexpr std::uint16_t kWireVersion = 2;

enum class MessageType : std::uint8_t { kHello = 1, kFrame, kCan, kPose, kEnd, kBusy };

struct Header {
  std::uint32_t length = 0;
  MessageType type = MessageType::kHello;
};
inline constexpr std::size_t kHeaderBytes = 5;
// A frame of the largest lens, with room to spare. A longer message is no message of a daemon's.
inline constexpr std::uint32_t kMaxLength = 80'000'000;

struct Hello {
  std::string robot;
  std::string software;
  std::string devices;
  RobotConfig config;
  WheelCodecConfig odometry;
  std::string can_interface;
  std::string dbc;  // content of odometry.dbc.file; empty for other codecs
};

struct FrameHead {
  Time stamp;
  std::uint64_t sequence = 0;
  int width = 0;
  int height = 0;
};
inline constexpr std::size_t kFrameHeadBytes = 24;

struct TappedPose {
  Time stamp;
  Pose2 pose;
};
inline constexpr std::size_t kPoseBytes = 32;

inline constexpr std::size_t kCanBytes = 22;

struct End {
  std::uint64_t frames = 0;
  std::uint64_t frames_dropped = 0;  // the recorder was too slow
  std::uint64_t can = 0;
  std::uint64_t can_dropped = 0;
  std::uint64_t poses = 0;
  std::uint64_t poses_dropped = 0;
  std::string why;
};

// --- writing: whole messages with their headers; 0, or empty, when the room is too small
// ----------

std::vector<std::uint8_t> write_hello(const Hello& hello);
// Without the pixels, which follow.
std::size_t write_frame_head(const FrameHead& head, std::span<std::uint8_t> room);
std::size_t write_can(std::span<const CanFrame> frames, std::span<std::uint8_t> room);
std::size_t write_pose(const TappedPose& pose, std::span<std::uint8_t> room);
std::size_t write_end(const End& end, std::span<std::uint8_t> room);
std::size_t write_busy(std::span<std::uint8_t> room);

// --- reading: what stands after the header. Errors say what is wrong with it. What is read is of
// its kind: names are names, numbers within a robot's ranges, texts fit for a terminal, and the DBC
// file is one that a decoder understands
// ----------------------

Result<Header> read_header(std::span<const std::uint8_t, kHeaderBytes> bytes);
Result<Hello> read_hello(std::span<const std::uint8_t> bytes);
// `pixels` views into `bytes`.
Result<FrameHead> read_frame(std::span<const std::uint8_t> bytes,
                             std::span<const std::uint8_t>& pixels);
Status read_can(std::span<const std::uint8_t> bytes, std::vector<CanFrame>& frames);
Result<TappedPose> read_pose(std::span<const std::uint8_t> bytes);
Result<End> read_end(std::span<const std::uint8_t> bytes);

}  // namespace zenith::tap
