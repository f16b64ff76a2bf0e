#include "drivers/radio/endpoint_text.h"

#include <net/if.h>

#include <gtest/gtest.h>

namespace zenith {
namespace {

TEST(EndpointText, ReadsAndWritesAddresses) {
  const auto v4 = parse_endpoint("192.168.1.7:5", 21474);
  ASSERT_TRUE(v4.ok()) << v4.error().message;
  EXPECT_FALSE(v4->is_ipv6);
  EXPECT_EQ(v4->port, 5);
  EXPECT_EQ(v4->address[0], 192);
  EXPECT_EQ(v4->address[3], 7);
  EXPECT_EQ(endpoint_text(*v4), "192.168.1.7:5");

  const auto v6 = parse_endpoint("[fd00::17]:65535", 21474);
  ASSERT_TRUE(v6.ok()) << v6.error().message;
  EXPECT_TRUE(v6->is_ipv6);
  EXPECT_EQ(v6->port, 65535);
  EXPECT_EQ(endpoint_text(*v6), "[fd00::17]:65535");

  EXPECT_EQ(endpoint_text(*parse_endpoint("10.0.0.1", 7)), "10.0.0.1:7");
  EXPECT_EQ(endpoint_text(*parse_endpoint("fd00::1", 7)), "[fd00::1]:7");
  EXPECT_EQ(endpoint_text(*parse_endpoint("[fd00::1]", 7)), "[fd00::1]:7");
}

TEST(EndpointText, KnowsInterfacesOfLinkLocalAddresses) {
  const auto local = parse_endpoint("[fe80::1%lo]:7", 1);
  ASSERT_TRUE(local.ok());
  EXPECT_EQ(local->interface, ::if_nametoindex("lo"));
  EXPECT_EQ(endpoint_text(*local), "[fe80::1%lo]:7");
  const auto absent = parse_endpoint("[fe80::1%nowlan7]:7", 1);
  ASSERT_TRUE(absent.ok()) << "an interface may come later";
  EXPECT_EQ(absent->interface, 0u);
}

TEST(EndpointText, RefusesWhatIsNone) {
  for (const char* text :
       {"", "robot7", "10.0.0", "10.0.0.256", "10.0.0.1:", "10.0.0.1:0", "10.0.0.1:65536",
        "10.0.0.1:7x", "10.0.0.1%lo", "[10.0.0.1]:7", "[fd00::1", "[fd00::1]7",
        "[fd00::1]:", "fd00::1%", "[]:7", ":7", "10.0.0.1 "}) {
    EXPECT_FALSE(parse_endpoint(text, 1).ok()) << "'" << text << "'";
  }
}

TEST(EndpointText, ReadsLists) {
  const auto none = parse_endpoints("  ", 1);
  ASSERT_TRUE(none.ok());
  EXPECT_TRUE(none->empty());
  const auto two = parse_endpoints("10.0.0.1 ,[fd00::2]:9", 21474);
  ASSERT_TRUE(two.ok()) << two.error().message;
  ASSERT_EQ(two->size(), 2u);
  EXPECT_EQ((*two)[0].port, 21474);
  EXPECT_EQ((*two)[1].port, 9);
  EXPECT_FALSE(parse_endpoints("10.0.0.1,", 1).ok());
  EXPECT_FALSE(parse_endpoints("10.0.0.1,,10.0.0.2", 1).ok());
}

TEST(EndpointText, GroupsAreMulticast) {
  EXPECT_TRUE(parse_group("239.255.90.78").ok());
  EXPECT_TRUE(parse_group("224.0.0.1").ok());
  EXPECT_TRUE(parse_group("ff02::5a4e").ok());
  for (const char* text :
       {"", "223.1.1.1", "240.0.0.1", "fe80::1", "239.255.90.78:7", "ff02::5a4e%lo", "group"}) {
    EXPECT_FALSE(parse_group(text).ok()) << "'" << text << "'";
  }
}

}  // namespace
}  // namespace zenith
