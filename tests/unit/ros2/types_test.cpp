// The bridge's messages are ROS 2's: names, fields, order, types.

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/unit/ros2/type_hash.h"
#include "tools/ros2/topic_types.h"

namespace zenith::ros2 {
namespace {

const std::string kIdl = ZENITH_SOURCE_DIR "/tools/ros2/idl";

// The hashes in topic_types.cpp are those that ROS 2's own generator made of its .msg files: equal
// ones mean that the IDL describes the same message to the last field's name.
TEST(Ros2Types, TheIdlDescribesRos2sOwnMessages) {
  EXPECT_EQ(topic_types().size(), 6u);
  for (const TopicType* type : topic_types()) {
    EXPECT_EQ(type_hash(kIdl, std::string(type->name)), type->hash) << type->name;
  }
}

TEST(Ros2Types, HaveTheNamesThatRos2GivesThemInDds) {
  for (const TopicType* type : topic_types()) {
    const std::string name(type->name);
    const std::string package = name.substr(0, name.find('/'));
    const std::string message = name.substr(name.rfind('/') + 1);
    EXPECT_EQ(type->descriptor->m_typename, package + "::msg::dds_::" + message + "_");
  }
}

TEST(Ros2Types, AreFinalAndCarryNoTypeInformation) {
  for (const TopicType* type : topic_types()) {
    EXPECT_EQ(type->descriptor->type_information.sz, 0u) << type->name;
    EXPECT_EQ(type->descriptor->m_nkeys, 0u) << type->name;
    // A final type's description begins with its fields, not with a delimiter (DLC) or parameter
    // list (PLC).
    EXPECT_EQ(type->descriptor->m_ops[0] >> 24U, DDS_OP_ADR >> 24U) << type->name;
  }
}

}  // namespace
}  // namespace zenith::ros2
