#include "tools/fleet/demo.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <vector>

#include "platform/linux/clock.h"
#include "sim/simulation.h"
#include "sim/world.h"
#include "tools/atomic_output.h"
#include "tools/fleet/child_process.h"
#include "tools/fleet/observer.h"
#include "tools/scratch_folder.h"
#include "tools/view/timeline.h"
#include "tools/view/timeline_recorder.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr Duration kSecond = {1'000'000'000};
// All have arrived when none has moved for so long, after some way.
constexpr double kStandsFor_s = 4.0;
constexpr double kSomeWay_m = 5.0;
constexpr double kLimit_s = 600.0;
// Landmarks of two robots that lie so near to each other are shown as one.
constexpr double kSame_m = 0.08;

RadioSettings radio_settings() {
  RadioSettings settings;
  settings.interface = "lo";
  settings.own_port = 0;
  return settings;
}

Status write_configuration(const fs::path& folder, const std::string& robot, const FleetDemo& demo,
                           const fs::path& sockets) {
  return write_file(
      folder / (robot + ".toml"),
      "[robot]\nname = \"" + robot + "\"\n\n[camera]\ndriver = \"simulated\"\n\n" +
          "[odometry]\ndriver = \"simulated\"\n\n[telemetry]\nsocket = \"" +
          (sockets / robot).string() + ".sock\"\n\n" +
          "[record]\nenabled = false\n\n[realtime]\npriority = 0\n" +
          "lock_memory = false\nhold_cpu_awake = false\n\n" +
          "# The robots drive more slowly where the computer is slow: no need to shed.\n" +
          "[load]\ncorners_min = 128\n\n[radio]\n" +
          "key_file = \"fleet.key\"\ninterface = \"lo\"\nown_port = 0\n\n" +
          "[simulation]\nworld = \"" + sim::find_world(demo.world).string() + "\"\nrobot = \"" +
          robot + "\"\nseed = " + std::to_string(demo.seed) + "\n");
}

struct Watched {
  ChildProcess daemon;
  RobotLog log;
  double way_m = 0.0;
  Time moved;
  std::vector<std::string> merged;  // told
  ObservedRobot seen;
};

LandmarkEstimate estimate_of(const LandmarkRecord& record) {
  LandmarkEstimate estimate;
  estimate.id = record.id;
  estimate.position_m = {record.x_m, record.y_m, record.z_m};
  const auto& c = record.covariance_m2;
  estimate.covariance_m2 << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  estimate.observations = record.observations;
  return estimate;
}

int index_of(const std::vector<Watched>& robots, std::uint64_t robot) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].seen.robot == robot) return static_cast<int>(i);
  }
  return -1;
}

PeerLog peer_log(const exchange::AlignmentNotice& notice, int peer) {
  PeerLog log;
  log.peer = peer;
  log.state = notice.state == exchange::AlignmentNotice::State::kMerged ? AlignmentState::kMerged
              : notice.state == exchange::AlignmentNotice::State::kWithdrawn
                  ? AlignmentState::kWithdrawn
                  : AlignmentState::kCandidate;
  log.T_own_peer = notice.T_own_peer;
  for (int i = 0; i < 3; ++i) {
    log.variance[i] = notice.deviations[static_cast<std::size_t>(i)] *
                      notice.deviations[static_cast<std::size_t>(i)];
  }
  log.confidence = notice.confidence;
  log.correspondences = notice.correspondences;
  return log;
}

void note(std::vector<Watched>& robots, std::size_t own, Time now, Time started) {
  Watched& robot = robots[own];
  FrameLog frame;
  frame.stamp = Time{} + (now - started);
  frame.T_start_robot = robot.seen.state.T_start_robot;
  for (const auto& notice : robot.seen.state.alignments) {
    const int peer = index_of(robots, notice.robot);
    if (peer < 0) continue;
    frame.peers.push_back(peer_log(notice, peer));
    const std::string& name = robots[static_cast<std::size_t>(peer)].log.name;
    if (frame.peers.back().state != AlignmentState::kMerged ||
        std::find(robot.merged.begin(), robot.merged.end(), name) != robot.merged.end()) {
      continue;
    }
    robot.merged.push_back(name);
    std::printf("   %3.0f s  %s has found itself in %s's map and joins both\n",
                (now - started).seconds(), robot.log.name.c_str(), name.c_str());
  }
  // The first pose is the start: all that is told of the truth.
  if (robot.log.frames.empty()) {
    frame.T_start_robot = {};
  } else {
    frame.truth.reset();
    const double step =
        (frame.T_start_robot.position() - robot.log.frames.back().T_start_robot.position()).norm();
    robot.way_m += step;
    if (step > 0.01) robot.moved = now;
  }
  robot.log.frames.push_back(std::move(frame));
}

void print_progress(const std::vector<Watched>& robots, Time now, Time started) {
  std::printf("   %3.0f s ", (now - started).seconds());
  for (const Watched& robot : robots) {
    std::printf(" %s: %4.1f m, %4zu landmarks %s", robot.log.name.c_str(), robot.way_m,
                robot.seen.landmarks.size(), &robot == &robots.back() ? "" : "|");
  }
  std::printf("\n");
  std::fflush(stdout);
}

bool all_arrived(const std::vector<Watched>& robots, Time now) {
  return std::all_of(robots.begin(), robots.end(), [now](const Watched& robot) {
    return robot.way_m > kSomeWay_m && (now - robot.moved).seconds() > kStandsFor_s;
  });
}

Status watch(const FleetDemo& demo, FleetObserver& observer, std::vector<Watched>& robots) {
  const Time started = monotonic_now();
  const double limit_s = demo.duration_s > 0.0 ? demo.duration_s : kLimit_s;
  Time next_line = started;
  while (true) {
    observer.run_for({500'000'000});
    if (demo.stopped && demo.stopped()) return Error{"ended before the robots had arrived"};
    const Time now = monotonic_now();
    for (ObservedRobot& seen : observer.robots()) {
      for (Watched& robot : robots) {
        if (robot.log.name == seen.name) robot.seen = std::move(seen);
      }
    }
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (!robots[i].daemon.is_running()) {
        return Error{"zenithd-sim of robot " + robots[i].log.name + " has ended; see " +
                     robots[i].log.name + ".log"};
      }
      if (robots[i].seen.robot != 0) note(robots, i, now, started);
    }
    if (now >= next_line) {
      next_line = now + Duration{5 * kSecond.ns};
      print_progress(robots, now, started);
    }
    if ((now - started).seconds() > limit_s || all_arrived(robots, now)) return {};
  }
}

// Own landmarks, and those of the robots that this one has merged with; near ones as one.
void fuse(const std::vector<Watched>& robots, std::size_t own, RobotLog& log) {
  for (const LandmarkEstimate& mark : log.landmarks) log.fused.push_back({mark, 1, -1});
  const std::size_t own_count = log.fused.size();
  for (const PeerLog& peer : log.frames.back().peers) {
    if (peer.state != AlignmentState::kMerged) continue;
    const Eigen::Matrix2d R = rotation(peer.T_own_peer.theta_rad);
    for (const auto& [id, record] : robots[static_cast<std::size_t>(peer.peer)].seen.landmarks) {
      LandmarkEstimate mark = estimate_of(record);
      mark.position_m.head<2>() = peer.T_own_peer * mark.position_m.head<2>();
      mark.covariance_m2.topLeftCorner<2, 2>() =
          (R * mark.covariance_m2.topLeftCorner<2, 2>() * R.transpose()).eval();
      FusedLandmark* nearest = nullptr;
      double distance = kSame_m;
      for (std::size_t i = 0; i < own_count; ++i) {
        const double d = (log.fused[i].landmark.position_m - mark.position_m).head<2>().norm();
        if (d < distance) {
          distance = d;
          nearest = &log.fused[i];
        }
      }
      if (nearest != nullptr) {
        nearest->owners = 2;
      } else {
        log.fused.push_back({mark, 1, slot_of_peer(static_cast<int>(own), peer.peer)});
      }
    }
  }
}

TeamLog team_log(std::vector<Watched>& robots) {
  for (Watched& robot : robots) {
    for (const auto& [id, record] : robot.seen.landmarks) {
      robot.log.landmarks.push_back(estimate_of(record));
    }
    robot.log.correspondences.resize(robots.size());
  }
  TeamLog team;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!robots[i].log.frames.empty()) fuse(robots, i, robots[i].log);
  }
  for (Watched& robot : robots) team.robots.push_back(std::move(robot.log));
  return team;
}

}  // namespace

Result<fs::path> find_simulated_daemon() {
  if (const char* given = std::getenv("ZENITHD_SIM"); given != nullptr) return fs::path(given);
  std::error_code code;
  const fs::path here = fs::read_symlink("/proc/self/exe", code).parent_path();
  for (const fs::path& candidate :
       {here / "zenithd-sim", here.parent_path() / "platform" / "daemon" / "zenithd-sim"}) {
    if (fs::exists(candidate, code)) return candidate;
  }
  return Error{"zenithd-sim is neither beside " + here.string() +
               "/zenith nor where the build puts it; build it, or set ZENITHD_SIM, or take "
               "--offline, which needs none"};
}

Result<TeamLog> run_fleet_demo(const FleetDemo& demo, const fs::path& folder) {
  const auto program = find_simulated_daemon();
  if (!program.ok()) return program.error();
  sim::SimOptions options;
  options.seed = demo.seed;
  const auto simulation = sim::Simulation::load(sim::find_world(demo.world), options);
  if (!simulation.ok()) return simulation.error();
  if (const Status made = create_fleet_key(folder / "fleet.key"); !made) return made.error();
  const auto keys = read_fleet_keys(folder / "fleet.key");
  if (!keys.ok()) return keys.error();
  FleetObserver observer(*keys, radio_settings());
  if (const Status opened = observer.open(); !opened) return opened.error();

  const ScratchFolder sockets;  // a socket's path must be short: not every output folder's is
  std::vector<std::string> names;
  std::vector<RobotAddress> addresses;
  std::vector<Watched> robots;
  for (std::size_t i = 0; i < simulation->robot_count(); ++i) {
    const std::string name = simulation->drive(i).name();
    const std::string socket = (sockets.path() / (name + ".sock")).string();
    names.push_back(name);
    addresses.push_back({"", {socket}, socket});
    if (const Status written = write_configuration(folder, name, demo, sockets.path()); !written) {
      return written.error();
    }
    auto daemon =
        ChildProcess::start({program->string(), "--config", (folder / (name + ".toml")).string()},
                            folder / (name + ".log"));
    if (!daemon.ok()) return daemon.error();
    robots.push_back({std::move(*daemon), {}, 0.0, monotonic_now(), {}, {}});
    robots.back().log.name = name;
  }
  if (demo.on_start) {
    if (const Status started = demo.on_start(addresses); !started) return started.error();
  }
  TimelineRecorder timeline(folder / kTimelineFile, names, addresses);
  if (const Status watched = watch(demo, observer, robots); !watched) return watched.error();
  if (const Status written = timeline.finish(); !written) return written.error();
  observer.leave();
  for (Watched& robot : robots) robot.daemon.stop();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (robots[i].log.frames.empty()) {
      return Error{"nothing was heard of robot " + robots[i].log.name + "; see " +
                   robots[i].log.name + ".log"};
    }
    robots[i].log.frames.front().truth = simulation->drive(i).T_world_robot(Time{0});
  }
  return team_log(robots);
}

}  // namespace zenith::tools
