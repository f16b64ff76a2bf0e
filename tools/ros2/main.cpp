// zenith-ros2: robots as ROS 2's topics, over Cyclone DDS.

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"
#include "platform/linux/printable_output.h"
#include "platform/linux/signals.h"
#include "tools/ros2/bridge.h"

namespace {

using namespace zenith;

constexpr const char* kHelp =
    R"(Reads what zenithd tells on its telemetry socket and publishes it as ROS 2's topics, for Humble
and later; ROS itself is not needed here. Neither the daemon nor its map depend on it.

  /odom                   nav_msgs/Odometry             wheels alone, continuous
  /pose                   PoseWithCovarianceStamped     in the map
  /landmarks              sensor_msgs/PointCloud2       the map
  /peers/NAME/...         alignment, confidence and landmarks of another robot's map
  /tf, /tf_static         map -> odom -> base_link, map -> NAME/map
  /diagnostics            how the robots are

With several robots topics and frames begin with their names: /anna/odom, anna/map.

ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY and CYCLONEDDS_URI have their usual meaning.

Examples:
  zenith-ros2
  zenith-ros2 --domain 7 ssh:anna ssh:bert
  zenith-ros2 --names always --no-peers-tf     on each robot of a fleet)";

struct Arguments {
  std::vector<std::string> robots = {""};
  std::string names = "auto";
  bool no_tf = false;
  bool no_peers_tf = false;
  ros2::BridgeOptions options;
};

int fail(const Error& error) {
  process_log().drain(monotonic_now());
  std::fprintf(stderr, "zenith-ros2: error: %s\n", error.message.c_str());
  return 1;
}

void add_options(CLI::App& app, Arguments& a) {
  app.footer(kHelp);
  app.set_version_flag("--version", "zenith-ros2 " ZENITH_VERSION);
  app.add_option("ROBOT", a.robots,
                 "telemetry sockets, ssh:HOST or ssh:HOST:SOCKET; without any the usual places of "
                 "this computer");
  app.add_option("--domain", a.options.domain, "DDS domain, 0 to 232")
      ->envname("ROS_DOMAIN_ID")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app.add_option("--names", a.names,
                 "whether topics and frames begin with the robot's name: auto is with several")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
  app.add_option("--map-frame", a.options.frames.map, "where the robot's own start is the origin")
      ->capture_default_str();
  app.add_option("--odom-frame", a.options.frames.odom, "the frame that the wheels keep")
      ->capture_default_str();
  app.add_option("--base-frame", a.options.frames.base, "the robot, on the floor below its axle")
      ->capture_default_str();
  app.add_flag("--no-tf", a.no_tf, "no transforms map -> odom -> base_link");
  app.add_flag("--no-peers-tf", a.no_peers_tf,
               "no transforms between robots' maps: for all bridges but one");
}

int run(Arguments& a, Signals& signals) {
  auto robots = tools::parse_robot_addresses(a.robots);
  if (!robots) return fail(robots.error());
  if (a.names == "never" && robots->size() > 1) {
    return fail(
        {"expected --names auto or always with several robots, found never: their topics "
         "and frames would be the same"});
  }
  const char* localhost = std::getenv("ROS_LOCALHOST_ONLY");
  a.options.localhost = localhost != nullptr && std::string(localhost) == "1";
  a.options.prefixed = a.names == "always" || (a.names == "auto" && robots->size() > 1);
  a.options.transforms = !a.no_tf;
  a.options.peers_transforms = !a.no_peers_tf;
  Log& log = process_log();
  auto bridge = ros2::Bridge::start(a.options, std::move(*robots));
  if (!bridge) return fail(bridge.error());
  log_line(LogLevel::kNotice, "in DDS domain %u", a.options.domain);
  constexpr Duration kSlice = {200'000'000};
  while (signals.wait({0}) != SignalRequest::kStop) {
    log.drain(monotonic_now());
    (*bridge)->turn(kSlice, signals.fd());
  }
  log.drain(monotonic_now());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  make_output_printable();
  Signals signals;
  if (const Status opened = signals.open(); !opened) return fail(opened.error());
  CLI::App app("Zenith's robots as ROS 2's topics.", "zenith-ros2");
  Arguments arguments;
  try {
    add_options(app, arguments);
    app.parse(argc, argv);
    return run(arguments, signals);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "zenith-ros2: error: %s\n", error.what());
    return 1;
  }
}
