#include "tools/ros2/landmark_cloud.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "tools/ros2/convert.h"

namespace zenith::ros2 {
namespace {

// sensor_msgs/msg/PointField's numbers.
constexpr std::uint8_t kUint32 = 6;
constexpr std::uint8_t kFloat32 = 7;

struct Field {
  const char* name;
  std::uint8_t type;
};
constexpr std::array<Field, 7> kFields = {{{"x", kFloat32},
                                           {"y", kFloat32},
                                           {"z", kFloat32},
                                           {"id", kUint32},
                                           {"observations", kUint32},
                                           {"sigma_xy", kFloat32},
                                           {"sigma_z", kFloat32}}};
static_assert(4 * kFields.size() == LandmarkCloud::kPointBytes);

void append(std::vector<std::uint8_t>& data, std::uint32_t word) {
  std::array<std::uint8_t, sizeof word> bytes;
  std::memcpy(bytes.data(), &word, sizeof word);
  data.insert(data.end(), bytes.begin(), bytes.end());
}

void append(std::vector<std::uint8_t>& data, double value) {
  append(data, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

// The square root of the larger eigenvalue.
double longer_axis(double xx, double xy, double yy) {
  const double half = 0.5 * (xx + yy);
  return std::sqrt(std::max(half + std::hypot(0.5 * (xx - yy), xy), 0.0));
}

}  // namespace

LandmarkCloud::LandmarkCloud(std::int64_t system_ns, std::string frame,
                             const std::vector<tools::RobotState::Row>& rows)
    : frame_(std::move(frame)) {
  std::uint32_t offset = 0;
  for (const Field& field : kFields) {
    fields_.push_back({const_cast<char*>(field.name), offset, field.type, 1});
    offset += 4;
  }
  for (const auto& [id, x, y, z, xx, xy, yy, zz, observations] : rows) {
    for (const double position : {x, y, z}) append(data_, position);
    append(data_, static_cast<std::uint32_t>(id));
    append(data_, static_cast<std::uint32_t>(observations));
    append(data_, longer_axis(xx, xy, yy));
    append(data_, std::sqrt(std::max(zz, 0.0)));
  }
  message_.header = to_header(system_ns, frame_);
  message_.height = 1;
  message_.width = static_cast<std::uint32_t>(rows.size());
  message_.fields = to_sequence<decltype(message_.fields)>(fields_);
  message_.is_bigendian = std::endian::native == std::endian::big;
  message_.point_step = kPointBytes;
  message_.row_step = message_.width * kPointBytes;
  message_.data = to_sequence<decltype(message_.data)>(data_);
  message_.is_dense = true;
}

}  // namespace zenith::ros2
