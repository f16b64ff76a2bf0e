#include "slam/exchange/record_code.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zenith::exchange {
namespace {

constexpr std::uint8_t kRemovedBit = 0x80;
constexpr std::uint8_t kLooksMask = 0x0F;
constexpr std::size_t kRevisionAt = 4;

struct Quantised {
  std::array<std::int32_t, 3> place_mm = {};
  std::array<std::uint8_t, 3> deviations = {};
  Correlations correlations = {};
};

bool quantise(const LandmarkRecord& record, Quantised& out) {
  const auto& covariance = record.covariance_m2;
  for (const float c : covariance) {
    if (!std::isfinite(c)) return false;
  }
  if (!encode_place(record.x_m, out.place_mm[0]) || !encode_place(record.y_m, out.place_mm[1]) ||
      !encode_place(record.z_m, out.place_mm[2])) {
    return false;
  }
  if (!encode_variance(covariance[0], out.deviations[0]) ||
      !encode_variance(covariance[3], out.deviations[1]) ||
      !encode_variance(covariance[5], out.deviations[2])) {
    return false;
  }
  out.correlations = encode_correlations(covariance);
  return true;
}

void write_look(ByteWriter& out, const AppearanceRecord& look) {
  out.u8(encode_turn8(look.direction_rad));
  out.bytes(encode_coefficients(look.descriptor));
}

}  // namespace

bool encode_record(const LandmarkRecord& record, EncodedRecord& out) {
  Quantised quantised;
  if (!record.removed && !quantise(record, quantised)) return false;
  const auto looks = std::min<std::size_t>(record.appearance_count, kPublishedAppearances);
  ByteWriter writer(out.data);
  writer.u32(record.id);
  writer.u16(0);
  writer.u8(record.removed ? kRemovedBit : static_cast<std::uint8_t>(looks));
  writer.u8(static_cast<std::uint8_t>(std::min<int>(record.observations, 255)));
  if (!record.removed) {
    for (const std::int32_t mm : quantised.place_mm) writer.i24(mm);
    for (const std::uint8_t k : quantised.deviations) writer.u8(k);
    for (const std::int8_t c : quantised.correlations) writer.i8(c);
    for (std::size_t i = 0; i < looks; ++i) write_look(writer, record.appearances[i]);
  }
  out.size = static_cast<std::uint8_t>(writer.size());
  return true;
}

void append_record(ByteWriter& out, const EncodedRecord& record,
                   std::uint16_t revision_less_first) {
  const std::size_t start = out.size();
  out.bytes(record.bytes());
  assert(!out.failed());
  out.overwrite_u16(start + kRevisionAt, revision_less_first);
}

bool decode_record(ByteReader& in, std::uint32_t first, LandmarkRecord& record) {
  record = LandmarkRecord{};
  record.id = in.u32();
  record.revision = first + in.u16();
  const std::uint8_t flags = in.u8();
  record.removed = (flags & kRemovedBit) != 0;
  record.observations = in.u8();
  if (in.failed() || record.revision < first) return false;
  if (record.removed) return true;

  record.appearance_count = flags & kLooksMask;
  if (record.appearance_count > kPublishedAppearances) return false;
  for (float* place : {&record.x_m, &record.y_m, &record.z_m}) {
    const std::int32_t mm = in.i24();
    if (mm < -kMaxPlace_mm) return false;
    *place = decode_mm(mm);
  }
  const std::array<std::uint8_t, 3> deviations = {in.u8(), in.u8(), in.u8()};
  const Correlations correlations = {in.i8(), in.i8(), in.i8()};
  if (!semidefinite(correlations)) return false;
  record.covariance_m2 = decode_covariance(deviations, correlations);
  for (std::size_t i = 0; i < record.appearance_count; ++i) {
    AppearanceRecord& look = record.appearances[i];
    look.direction_rad = decode_turn8(in.u8());
    const Bytes coefficients = in.take(kLookBytes);
    if (in.failed() || !decode_coefficients(coefficients.data(), look.descriptor)) return false;
  }
  return !in.failed();
}

}  // namespace zenith::exchange
