#include "platform/daemon/tap/wire.h"

#include <algorithm>
#include <cmath>

#include "drivers/odometry/dbc.h"
#include "platform/base/bytes.h"
#include "platform/base/printable.h"
#include "platform/config/lens_settings.h"
#include "platform/config/robot_settings.h"

namespace zenith::tap {
namespace {

constexpr std::string_view kMagic = "ZTAP";
constexpr int kMaxSide = 8192;
constexpr std::size_t kHelloRoom = std::size_t{8} * 1024;  // texts and DBC file come on top
constexpr std::size_t kMostText = 4096;
constexpr double kMostNumber = 1e6;  // metres, pixels, radians: of no robot

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Error wrong(const char* what) {
  return Error{std::string("the daemon's message '") + what +
               "' is not as expected: are daemon and tool of one version?"};
}

// Writes a message into `room`: the header's length is known when its fields are.
template <typename Fields>
std::size_t write_message(MessageType type, std::span<std::uint8_t> room, Fields fields) {
  if (room.size() < kHeaderBytes) return 0;
  ByteWriter writer(room.subspan(kHeaderBytes));
  fields(writer);
  if (writer.failed() || writer.size() > kMaxLength) return 0;
  ByteWriter(room)
      .u32(static_cast<std::uint32_t>(writer.size()))
      .u8(static_cast<std::uint8_t>(type));
  return kHeaderBytes + writer.size();
}

// --- the codec's keys ----------------------------------------------------------------------------

// One type of key each; the numbers are the wire's.
struct WriteValue {
  ByteWriter& out;
  WheelCodecConfig& config;
  void operator()(double* (*at)(WheelCodecConfig&)) const { out.u8(1).f64(*at(config)); }
  void operator()(std::uint32_t* (*at)(WheelCodecConfig&)) const { out.u8(2).u32(*at(config)); }
  void operator()(bool* (*at)(WheelCodecConfig&)) const { out.u8(3).u8(*at(config) ? 1 : 0); }
  void operator()(std::string* (*at)(WheelCodecConfig&)) const { out.u8(4).text(*at(config)); }
  void operator()(WheelQuantity* (*at)(WheelCodecConfig&)) const {
    out.u8(5).text(wheel_quantity_name(*at(config)));
  }
};

struct ReadValue {
  ByteReader& in;
  WheelCodecConfig& config;
  std::uint8_t kind;
  bool operator()(double* (*at)(WheelCodecConfig&)) const {
    *at(config) = in.f64();
    return kind == 1 && std::isfinite(*at(config));
  }
  bool operator()(std::uint32_t* (*at)(WheelCodecConfig&)) const {
    *at(config) = in.u32();
    return kind == 2;
  }
  bool operator()(bool* (*at)(WheelCodecConfig&)) const {
    *at(config) = in.u8() != 0;
    return kind == 3;
  }
  bool operator()(std::string* (*at)(WheelCodecConfig&)) const {
    const std::string_view text = in.text();
    *at(config) = text;
    return kind == 4 && text.size() <= kMostText && is_printable(text);
  }
  bool operator()(WheelQuantity* (*at)(WheelCodecConfig&)) const {
    const auto quantity = find_wheel_quantity(in.text());
    if (quantity) *at(config) = *quantity;
    return kind == 5 && quantity.has_value();
  }
};

void write_odometry(ByteWriter& out, WheelCodecConfig config) {
  out.text(wheel_codec_name(config.kind));
  const auto fields = wheel_codec_fields();
  out.u32(static_cast<std::uint32_t>(fields.size()));
  for (const WheelCodecField& field : fields) {
    out.text(field.key);
    std::visit(WriteValue{out, config}, field.at);
  }
}

// What a person reads. Nothing in it steers a terminal.
bool read_text(ByteReader& in, std::string& text) {
  const std::string_view raw = in.text();
  if (raw.size() > kMostText) return false;
  text = printable(raw);
  return true;
}

// Keys of other codecs are nothing that anybody reads: those may have any value.
bool is_in_range(const WheelCodecField& field, WheelCodecConfig& config) {
  if (!field.belongs_to(config.kind)) return true;
  const auto within = [&field](double value) { return value >= field.min && value <= field.max; };
  if (const auto* at = std::get_if<double* (*)(WheelCodecConfig&)>(&field.at)) {
    return within(*(*at)(config));
  }
  if (const auto* at = std::get_if<std::uint32_t* (*)(WheelCodecConfig&)>(&field.at)) {
    return within(*(*at)(config));
  }
  return true;
}

bool read_odometry(ByteReader& in, WheelCodecConfig& config) {
  const auto kind = find_wheel_codec(in.text());
  if (!kind) return false;
  config.kind = *kind;
  const auto fields = wheel_codec_fields();
  for (std::uint32_t left = in.u32(); left > 0 && !in.failed(); --left) {
    const std::string_view key = in.text();
    const std::uint8_t type = in.u8();
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [key](const WheelCodecField& f) { return f.key == key; });
    if (field == fields.end() || !std::visit(ReadValue{in, config, type}, field->at)) return false;
    if (!is_in_range(*field, config)) return false;
  }
  return !in.failed();
}

// Lines of text that a decoder understands, where one is wanted.
bool is_dbc(const WheelCodecConfig& odometry, const std::string& content) {
  const auto steers = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte == 0x7F || (byte < 0x20 && c != '\n' && c != '\r' && c != '\t' && c != '\f');
  };
  if (std::any_of(content.begin(), content.end(), steers)) return false;
  return odometry.kind != WheelCodecKind::kDbc || parse_dbc(content, "the base's DBC file").ok();
}

// --- the robot -----------------------------------------------------------------------------------

void write_robot(ByteWriter& out, const RobotConfig& config) {
  const Lens& l = config.lens;
  out.text(lens_model_name(l.model));
  out.u32(static_cast<std::uint32_t>(l.width_px)).u32(static_cast<std::uint32_t>(l.height_px));
  out.f64(l.fu_px).f64(l.fv_px).f64(l.cu_px).f64(l.cv_px);
  for (const LensNumber& number : lens_numbers(l.model)) out.f64(number.of(l));
  if (l.model == LensModel::kScaramuzza) {
    for (const double a : l.polynomial) out.f64(a);
    for (const double b : l.inverse_polynomial) out.f64(b);
  }
  const CameraMount& m = config.mount;
  out.f64(m.x_m).f64(m.y_m).f64(m.z_m).f64(m.roll_rad).f64(m.pitch_rad).f64(m.yaw_rad);
  const Wheels& w = config.wheels;
  out.f64(w.track_width_m).f64(w.left_scale).f64(w.right_scale).f64(config.frame_rate_hz);
}

bool read_lens(ByteReader& in, Lens& lens) {
  const auto model = find_lens_model(in.text());
  if (!model) return false;
  lens.model = *model;
  lens.width_px = static_cast<int>(std::min<std::uint32_t>(in.u32(), kMaxSide + 1));
  lens.height_px = static_cast<int>(std::min<std::uint32_t>(in.u32(), kMaxSide + 1));
  for (double* value : {&lens.fu_px, &lens.fv_px, &lens.cu_px, &lens.cv_px}) *value = in.f64();
  for (const LensNumber& number : lens_numbers(*model)) number.at(lens) = in.f64();
  if (*model == LensModel::kScaramuzza) {
    for (double& a : lens.polynomial) a = in.f64();
    for (double& b : lens.inverse_polynomial) b = in.f64();
  }
  return !in.failed() && check_lens(lens).ok();
}

bool read_robot(ByteReader& in, RobotConfig& config) {
  bool good = read_lens(in, config.lens);
  const auto number = [&] {
    const double value = in.f64();
    good = good && std::isfinite(value) && std::abs(value) <= kMostNumber;
    return value;
  };
  CameraMount& m = config.mount;
  for (double* value : {&m.x_m, &m.y_m, &m.z_m, &m.roll_rad, &m.pitch_rad, &m.yaw_rad}) {
    *value = number();
  }
  Wheels& w = config.wheels;
  for (double* value : {&w.track_width_m, &w.left_scale, &w.right_scale}) *value = number();
  config.frame_rate_hz = number();
  return good && config.frame_rate_hz > 0.0 && !in.failed();
}

}  // namespace

std::vector<std::uint8_t> write_hello(const Hello& hello) {
  std::vector<std::uint8_t> room(kHelloRoom + hello.robot.size() + hello.software.size() +
                                 hello.devices.size() + hello.can_interface.size() +
                                 hello.odometry.dbc.file.size() + hello.dbc.size());
  room.resize(write_message(MessageType::kHello, room, [&](ByteWriter& out) {
    out.bytes(bytes_of(kMagic)).u16(kWireVersion);
    out.text(hello.robot).text(hello.software).text(hello.devices);
    write_robot(out, hello.config);
    out.text(hello.can_interface);
    write_odometry(out, hello.odometry);
    out.text(hello.dbc);
  }));
  return room;
}

std::size_t write_frame_head(const FrameHead& head, std::span<std::uint8_t> room) {
  if (room.size() < kHeaderBytes + kFrameHeadBytes) return 0;
  const auto width = static_cast<std::uint32_t>(head.width);
  const auto height = static_cast<std::uint32_t>(head.height);
  ByteWriter writer(room);
  writer.u32(static_cast<std::uint32_t>(kFrameHeadBytes + std::size_t{width} * height));
  writer.u8(static_cast<std::uint8_t>(MessageType::kFrame));
  writer.i64(head.stamp.ns).u64(head.sequence).u32(width).u32(height);
  return writer.size();
}

std::size_t write_can(std::span<const CanFrame> frames, std::span<std::uint8_t> room) {
  return write_message(MessageType::kCan, room, [&](ByteWriter& out) {
    for (const CanFrame& frame : frames) {
      out.i64(frame.stamp.ns).u32(frame.id).u8(frame.extended ? 1 : 0).u8(frame.length);
      out.bytes(frame.data);
    }
  });
}

std::size_t write_pose(const TappedPose& pose, std::span<std::uint8_t> room) {
  return write_message(MessageType::kPose, room, [&](ByteWriter& out) {
    out.i64(pose.stamp.ns).f64(pose.pose.x_m).f64(pose.pose.y_m).f64(pose.pose.theta_rad);
  });
}

std::size_t write_end(const End& end, std::span<std::uint8_t> room) {
  return write_message(MessageType::kEnd, room, [&](ByteWriter& out) {
    out.u64(end.frames).u64(end.frames_dropped).u64(end.can).u64(end.can_dropped);
    out.u64(end.poses).u64(end.poses_dropped).text(end.why);
  });
}

std::size_t write_busy(std::span<std::uint8_t> room) {
  return write_message(MessageType::kBusy, room, [](ByteWriter&) {});
}

// Bytes after the header; later versions may add fields.
std::uint32_t longest(MessageType type) {
  constexpr std::uint32_t kHello = 20'000'000;  // a DBC file of 16 MB, with room to spare
  constexpr std::uint32_t kSmall = 16'384;
  switch (type) {
    case MessageType::kFrame:
      return kMaxLength;
    case MessageType::kHello:
      return kHello;
    case MessageType::kCan:
    case MessageType::kPose:
    case MessageType::kEnd:
    case MessageType::kBusy:
      break;
  }
  return kSmall;
}

Result<Header> read_header(std::span<const std::uint8_t, kHeaderBytes> bytes) {
  ByteReader in(bytes);
  const std::uint32_t length = in.u32();
  const std::uint8_t type = in.u8();
  if (type < static_cast<std::uint8_t>(MessageType::kHello) ||
      type > static_cast<std::uint8_t>(MessageType::kBusy) ||
      length > longest(static_cast<MessageType>(type))) {
    return wrong("header");
  }
  return Header{length, static_cast<MessageType>(type)};
}

Result<Hello> read_hello(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  const auto magic = in.take(kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), kMagic.begin(), kMagic.end())) return wrong("hello");
  const std::uint16_t version = in.u16();
  if (version != kWireVersion) {
    return Error{"the daemon's tap speaks version " + std::to_string(version) +
                 ", this tool version " + std::to_string(kWireVersion) +
                 ": use the tool that came with the daemon"};
  }
  Hello hello;
  const auto refused = [](const char* what, std::string_view found) {
    return Error{std::string("the daemon's message 'hello' tells a ") + what + " that is none: '" +
                 printable_start(found, 64) + "'"};
  };
  hello.robot = in.text();
  if (!in.failed() && !is_robot_name(hello.robot)) return refused("robot's name", hello.robot);
  if (!read_text(in, hello.software) || !read_text(in, hello.devices)) return wrong("hello");
  if (!read_robot(in, hello.config)) return wrong("hello");
  hello.can_interface = in.text();
  if (!in.failed() && !is_interface_name(hello.can_interface)) {
    return refused("CAN interface", hello.can_interface);
  }
  if (!read_odometry(in, hello.odometry)) return wrong("hello");
  hello.dbc = in.text();
  if (in.failed()) return wrong("hello");
  if (!is_dbc(hello.odometry, hello.dbc)) return refused("DBC file", hello.dbc);
  return hello;  // later versions may add fields
}

Result<FrameHead> read_frame(std::span<const std::uint8_t> bytes,
                             std::span<const std::uint8_t>& pixels) {
  ByteReader in(bytes);
  FrameHead head;
  head.stamp.ns = in.i64();
  head.sequence = in.u64();
  const std::uint32_t width = in.u32();
  const std::uint32_t height = in.u32();
  if (in.failed() || width < 1 || width > kMaxSide || height < 1 || height > kMaxSide ||
      in.left() != std::size_t{width} * height) {
    return wrong("frame");
  }
  head.width = static_cast<int>(width);
  head.height = static_cast<int>(height);
  pixels = in.take(in.left());
  return head;
}

Status read_can(std::span<const std::uint8_t> bytes, std::vector<CanFrame>& frames) {
  frames.clear();
  if (bytes.size() % kCanBytes != 0) return wrong("can");
  ByteReader in(bytes);
  while (in.left() > 0) {
    CanFrame frame;
    frame.stamp.ns = in.i64();
    frame.id = in.u32();
    frame.extended = in.u8() != 0;
    frame.length = in.u8();
    const auto data = in.take(frame.data.size());
    std::copy(data.begin(), data.end(), frame.data.begin());
    const std::uint32_t highest = frame.extended ? 0x1FFFFFFFU : 0x7FFU;
    if (frame.length > frame.data.size() || frame.id > highest) return wrong("can");
    frames.push_back(frame);
  }
  return {};
}

Result<TappedPose> read_pose(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  TappedPose pose;
  pose.stamp.ns = in.i64();
  pose.pose = {in.f64(), in.f64(), in.f64()};
  const Pose2& p = pose.pose;
  if (!in.done() || !std::isfinite(p.x_m + p.y_m + p.theta_rad)) return wrong("pose");
  return pose;
}

Result<End> read_end(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  End end;
  for (std::uint64_t* count : {&end.frames, &end.frames_dropped, &end.can, &end.can_dropped,
                               &end.poses, &end.poses_dropped}) {
    *count = in.u64();
  }
  if (!read_text(in, end.why) || in.failed()) return wrong("end");
  return end;
}

}  // namespace zenith::tap
