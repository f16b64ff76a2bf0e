#include "slam/exchange/messages.h"

#include <algorithm>
#include <cmath>

#include "slam/exchange/quantise.h"

namespace zenith::exchange {
namespace {

constexpr double kConfidenceUnit = 65535.0;

void append_pose(ByteWriter& out, const Pose2& pose) {
  out.i32(clamp_mm(pose.x_m));
  out.i32(clamp_mm(pose.y_m));
  out.u16(encode_turn16(pose.theta_rad));
}

Pose2 take_pose(ByteReader& in) {
  Pose2 pose;
  pose.x_m = in.i32() * 1e-3;
  pose.y_m = in.i32() * 1e-3;
  pose.theta_rad = decode_turn16(in.u16());
  return pose;
}

void append_alignment(ByteWriter& out, const AlignmentNotice& alignment) {
  out.u64(alignment.robot);
  out.u32(alignment.map);
  out.u8(static_cast<std::uint8_t>(alignment.state));
  append_pose(out, alignment.T_own_peer);
  for (const double deviation : alignment.deviations) out.u8(clamp_deviation(deviation));
  out.u16(alignment.correspondences);
  const double confidence = std::isnan(alignment.confidence) ? 0.0 : alignment.confidence;
  out.u16(
      static_cast<std::uint16_t>(std::round(std::clamp(confidence, 0.0, 1.0) * kConfidenceUnit)));
}

bool take_alignment(ByteReader& in, AlignmentNotice& alignment) {
  alignment.robot = in.u64();
  alignment.map = in.u32();
  const std::uint8_t state = in.u8();
  if (state > static_cast<std::uint8_t>(AlignmentNotice::State::kWithdrawn)) return false;
  alignment.state = static_cast<AlignmentNotice::State>(state);
  alignment.T_own_peer = take_pose(in);
  for (double& deviation : alignment.deviations) deviation = decode_deviation(in.u8());
  alignment.correspondences = in.u16();
  alignment.confidence = in.u16() / kConfidenceUnit;
  return !in.failed();
}

}  // namespace

bool append(ByteWriter& out, const Hello& hello) {
  if (!is_robot_name(hello.text())) return false;
  const std::size_t start = begin_section(out, SectionType::kHello);
  out.u8(static_cast<std::uint8_t>(hello.name.size()));
  for (const char c : hello.name) out.u8(static_cast<std::uint8_t>(c));
  return end_section(out, start);
}

bool append(ByteWriter& out, SectionType challenge_or_response, const Challenge& challenge) {
  const std::size_t start = begin_section(out, challenge_or_response);
  out.u64(challenge.robot);
  out.u64(challenge.boot);
  out.bytes(challenge.nonce);
  return end_section(out, start);
}

bool append(ByteWriter& out, const StateNotice& state) {
  const std::size_t start = begin_section(out, SectionType::kState);
  out.u32(state.map);
  out.u32(state.head);
  out.u32(state.present);
  out.u64(state.checksum);
  append_pose(out, state.T_start_robot);
  out.u8(static_cast<std::uint8_t>(state.health));
  out.u8(static_cast<std::uint8_t>(state.alignments.size()));
  for (const AlignmentNotice& alignment : state.alignments) append_alignment(out, alignment);
  return end_section(out, start);
}

bool append(ByteWriter& out, const Request& request) {
  const std::size_t start = begin_section(out, SectionType::kRequest);
  out.u64(request.robot);
  out.u32(request.map);
  out.u8(static_cast<std::uint8_t>(request.ranges.size()));
  for (const Range& range : request.ranges) {
    out.u32(range.first);
    out.u32(range.last);
  }
  return end_section(out, start);
}

bool append_bye(ByteWriter& out) {
  return end_section(out, begin_section(out, SectionType::kBye));
}

bool decode(Bytes body, Hello& out) {
  ByteReader in(body);
  const std::size_t length = in.u8();
  if (length > kMaxName) return false;
  out.name.clear();
  for (const std::uint8_t byte : in.take(length)) out.name.push_back(static_cast<char>(byte));
  return in.done() && is_robot_name(out.text());
}

bool decode(Bytes body, Challenge& out) {
  ByteReader in(body);
  out.robot = in.u64();
  out.boot = in.u64();
  for (std::uint8_t& byte : out.nonce) byte = in.u8();
  return in.done();
}

bool decode(Bytes body, StateNotice& out) {
  ByteReader in(body);
  out.map = in.u32();
  out.head = in.u32();
  out.present = in.u32();
  out.checksum = in.u64();
  out.T_start_robot = take_pose(in);
  const std::uint8_t health = in.u8();
  if (health > static_cast<std::uint8_t>(Health::kFault)) return false;
  out.health = static_cast<Health>(health);
  const std::size_t count = in.u8();
  if (count > kMaxAlignmentsTold) return false;
  out.alignments.clear();
  for (std::size_t i = 0; i < count; ++i) {
    AlignmentNotice alignment;
    if (!take_alignment(in, alignment)) return false;
    out.alignments.push_back(alignment);
  }
  return in.done() && out.head != kToHead && out.present <= out.head;
}

bool decode(Bytes body, Request& out) {
  ByteReader in(body);
  out.robot = in.u64();
  out.map = in.u32();
  const std::size_t count = in.u8();
  if (count > kMaxRangesAsked) return false;
  out.ranges.clear();
  for (std::size_t i = 0; i < count; ++i) {
    Range range;
    range.first = in.u32();
    range.last = in.u32();
    if (range.first == 0 || range.last < range.first) return false;
    out.ranges.push_back(range);
  }
  return in.done();
}

}  // namespace zenith::exchange
