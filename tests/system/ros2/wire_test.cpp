// What the bridge's writers say of themselves in discovery, and its bytes on the wire, read without
// Cyclone DDS's own decoder: as any other implementation sees them.

#include <cmath>
#include <cstring>

#include <dds/ddsi/ddsi_serdata.h>
#include <gmock/gmock.h>

#include "tests/system/ros2/bridge_rig.h"

namespace zenith {
namespace {

// CDR, little-endian: each number at a multiple of its size, counted from behind the header.
class CdrReader {
 public:
  explicit CdrReader(std::vector<unsigned char> bytes) : bytes_(std::move(bytes)) {}

  template <typename T>
  T number() {
    at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    T value = {};
    if (at_ + sizeof(T) <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();  // with the zero at its end
    if (size == 0 || at_ + size > bytes_.size()) return "";
    const std::string out(reinterpret_cast<const char*>(bytes_.data() + at_), size - 1);
    at_ += size;
    return out;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::vector<unsigned char> bytes_;
  std::size_t at_ = 0;
};

// The next sample with its header of four bytes; empty when none comes.
std::vector<unsigned char> take_bytes(dds_entity_t reader) {
  std::vector<unsigned char> out;
  wait_until(kPatience_s, [&] {
    ddsi_serdata* data = nullptr;
    dds_sample_info_t info = {};
    if (dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE) != 1) return false;
    out.resize(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, out.size(), out.data());
    ddsi_serdata_unref(data);
    return true;
  });
  return out;
}

TEST_F(BridgeRig, OdometryIsRos2sCdrByteForByte) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto odom = listener_->subscribe("rt/odom", ros2::kOdometry);
  ASSERT_TRUE(hears_motion({odom}));
  robot().say(pose_line(2'000'000'005, {1, 2, 0.5}, {3, 4, 0.5}));
  std::vector<unsigned char> bytes;
  do {
    bytes = take_bytes(odom);
    ASSERT_GT(bytes.size(), 12u);
  } while (bytes[8] == kProbe_ns);  // the stamp's nanoseconds
  // Plain CDR, little-endian, which ROS 2 reads; 0x07 and more would be XCDR2.
  EXPECT_EQ(bytes[0], 0x00);
  EXPECT_EQ(bytes[1], 0x01);
  CdrReader cdr({bytes.begin() + 4, bytes.end()});
  EXPECT_EQ(cdr.number<std::int32_t>(), 1'767'225'602);
  EXPECT_EQ(cdr.number<std::uint32_t>(), 5u);
  EXPECT_EQ(cdr.text(), "odom");
  EXPECT_EQ(cdr.text(), "base_link");
  for (const double expected : {3.0, 4.0, 0.0, 0.0, 0.0, std::sin(0.25), std::cos(0.25)}) {
    EXPECT_EQ(cdr.number<double>(), expected);
  }
  for (int i = 0; i < 36; ++i)
    EXPECT_EQ(cdr.number<double>() != 0.0, i % 6 % 5 < 2 && (i / 6) % 5 < 2);
  for (const double expected : {0.5, 0.0, 0.0, 0.0, 0.0, -0.25}) {
    EXPECT_EQ(cdr.number<double>(), expected);
  }
  for (int i = 0; i < 36; ++i) EXPECT_EQ(cdr.number<double>() != 0.0, i == 0 || i == 7 || i == 35);
  EXPECT_LT(cdr.left(), 4u) << "padding alone";
}

TEST_F(BridgeRig, ACloudIsRos2sCdrByteForByte) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const auto map = listener_->subscribe("rt/landmarks", ros2::kPointCloud, {5, true});
  ASSERT_TRUE(listener_->matched(map));
  robot().say(landmarks_line(-1, {7, 1.5, -2.5, 3.0, 1e-4, 0, 1e-4, 4e-4, 9}));
  robot().say(radio_line());
  std::vector<unsigned char> bytes = take_bytes(map);
  ASSERT_GT(bytes.size(), 4u);
  CdrReader cdr({bytes.begin() + 4, bytes.end()});
  cdr.number<std::int32_t>();
  cdr.number<std::uint32_t>();
  EXPECT_EQ(cdr.text(), "map");
  EXPECT_EQ(cdr.number<std::uint32_t>(), 1u);
  EXPECT_EQ(cdr.number<std::uint32_t>(), 1u);
  const auto fields = cdr.number<std::uint32_t>();
  EXPECT_EQ(fields, 7u);
  std::string names;
  for (std::uint32_t i = 0; i < fields && i < 7; ++i) {
    names += cdr.text() + " ";
    EXPECT_EQ(cdr.number<std::uint32_t>(), 4 * i);
    EXPECT_THAT(cdr.number<std::uint8_t>(), testing::AnyOf(6, 7));
    EXPECT_EQ(cdr.number<std::uint32_t>(), 1u);
  }
  EXPECT_EQ(names, "x y z id observations sigma_xy sigma_z ");
  EXPECT_EQ(cdr.number<std::uint8_t>(), 0u);
  EXPECT_EQ(cdr.number<std::uint32_t>(), 28u);
  EXPECT_EQ(cdr.number<std::uint32_t>(), 28u);
  EXPECT_EQ(cdr.number<std::uint32_t>(), 28u);  // bytes of data
  EXPECT_EQ(cdr.number<float>(), 1.5f);
  for (int i = 1; i < 7; ++i) cdr.number<float>();
  EXPECT_EQ(cdr.number<std::uint8_t>(), 1u);
  EXPECT_LT(cdr.left(), 4u) << "padding alone";
}

struct Told {
  std::string type;
  std::string user_data;
  bool reliable = false;
  bool latched = false;
  int depth = 0;
};

Told read_endpoint(const dds_builtintopic_endpoint_t& endpoint) {
  Told out;
  out.type = endpoint.type_name;
  void* bytes = nullptr;
  std::size_t size = 0;
  if (dds_qget_userdata(endpoint.qos, &bytes, &size)) {
    out.user_data.assign(static_cast<const char*>(bytes), size);
    dds_free(bytes);
  }
  dds_reliability_kind_t reliability = {};
  dds_durability_kind_t durability = {};
  dds_history_kind_t history = {};
  dds_duration_t blocks = 0;
  dds_qget_reliability(endpoint.qos, &reliability, &blocks);
  dds_qget_durability(endpoint.qos, &durability);
  dds_qget_history(endpoint.qos, &history, &out.depth);
  out.reliable = reliability == DDS_RELIABILITY_RELIABLE;
  out.latched = durability == DDS_DURABILITY_TRANSIENT_LOCAL;
  return out;
}

TEST_F(BridgeRig, WritersSayInDiscoveryWhatRos2LooksFor) {
  ASSERT_TRUE(start(1));
  robot().say(hello_line("anna"));
  const dds_entity_t publications = dds_create_reader(
      listener_->participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  std::map<std::string, Told> told;
  const bool all = take_until<dds_builtintopic_endpoint_t>(
      publications, [&](const dds_builtintopic_endpoint_t& e) {
        told[e.topic_name] = read_endpoint(e);
        return told.size() == 6;
      });
  ASSERT_TRUE(all) << told.size();
  const std::map<std::string, std::pair<const ros2::TopicType*, bool>> expected = {
      {"rt/odom", {&ros2::kOdometry, false}},
      {"rt/pose", {&ros2::kPoseWithCovarianceStamped, false}},
      {"rt/landmarks", {&ros2::kPointCloud, true}},
      {"rt/tf", {&ros2::kTransforms, false}},
      {"rt/tf_static", {&ros2::kTransforms, true}},
      {"rt/diagnostics", {&ros2::kDiagnostics, false}}};
  for (const auto& [topic, type] : expected) {
    const Told& found = told[topic];
    EXPECT_EQ(found.type, type.first->descriptor->m_typename) << topic;
    EXPECT_EQ(found.user_data, "typehash=" + std::string(type.first->hash) + ";") << topic;
    EXPECT_TRUE(found.reliable) << topic;
    EXPECT_EQ(found.latched, type.second) << topic;
  }
}

}  // namespace
}  // namespace zenith
