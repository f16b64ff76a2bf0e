#include "tests/support/architecture_rules.h"

#include <algorithm>
#include <array>
#include <optional>
#include <regex>
#include <sstream>

namespace zenith {
namespace {

bool starts_with(std::string_view s, std::string_view prefix) {
  return s.substr(0, prefix.size()) == prefix;
}

// Which room of the house a file lies in.
enum class Room {
  kBase,
  kSlamKernels,  // arithmetic on arrays, by instruction set: knows nothing of the rest
  kSlamCommon,   // plain types that all stages share
  kSlamImage,
  kSlamFilter,
  kSlamMap,
  kSlamFleet,
  kSlamExchange,  // peers' records over the network; the step does not know it
  kSlamWhole,     // all else right in slam/: the step, which calls the stages
  kDrivers,
  kLinux,
  kConfig,
  kRecording,
  kLink,
  kStorage,  // the map on disk
  kDaemon,
  kDaemonSimulated,  // its devices that come from the simulator
  kSim,
  kTools,
  kTests,
  kUnknown,
};

Room room_of(std::string_view path) {
  struct Entry {
    std::string_view prefix;
    Room room;
  };
  static constexpr std::array<Entry, 26> kRooms = {{
      {"platform/base/", Room::kBase},
      {"slam/kernels/", Room::kSlamKernels},
      {"slam/image/", Room::kSlamImage},
      {"slam/filter/", Room::kSlamFilter},
      {"slam/map/", Room::kSlamMap},
      {"slam/fleet/", Room::kSlamFleet},
      {"slam/exchange/", Room::kSlamExchange},
      {"slam/bounds.", Room::kSlamCommon},
      {"slam/capacity.", Room::kSlamCommon},
      {"slam/counters.", Room::kSlamCommon},
      {"slam/geometry.", Room::kSlamCommon},
      {"slam/parameters.", Room::kSlamCommon},
      {"slam/robot.", Room::kSlamCommon},
      {"slam/wheels.", Room::kSlamCommon},
      {"slam/", Room::kSlamWhole},
      {"drivers/", Room::kDrivers},
      {"platform/linux/", Room::kLinux},
      {"platform/config/", Room::kConfig},
      {"platform/recording/", Room::kRecording},
      {"platform/link/", Room::kLink},
      {"platform/storage/", Room::kStorage},
      {"platform/daemon/simulated/", Room::kDaemonSimulated},
      {"platform/daemon/", Room::kDaemon},
      {"sim/", Room::kSim},
      {"tools/", Room::kTools},
      {"tests/", Room::kTests},
  }};
  for (const Entry& entry : kRooms) {
    if (starts_with(path, entry.prefix)) return entry.room;
  }
  return Room::kUnknown;
}

bool is_slam(Room room) {
  return room >= Room::kSlamKernels && room <= Room::kSlamWhole;
}

// Data types of the core that those outside may pass around.
bool is_plain_slam_type(std::string_view path) {
  return room_of(path) == Room::kSlamCommon || path == "slam/image/image.h" ||
         path == "slam/image/lens.h" || path == "slam/image/lens_extent.h" ||
         path == "slam/image/lens_projection.h" || path == "slam/image/view.h" ||
         path == "slam/fleet/record.h";
}

// "drivers/odometry/codec.h" -> "drivers/odometry/"
std::string_view driver_folder(std::string_view path) {
  const std::size_t slash = path.find('/', std::string_view("drivers/").size());
  return path.substr(0, slash == std::string_view::npos ? path.size() : slash + 1);
}

using Broken = std::optional<std::string>;

Broken check_slam_include(Room from, const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == from) return {};
  if (!is_slam(to)) return "slam includes platform/base, Eigen and slam alone";
  if (from == Room::kSlamKernels) return "slam/kernels includes platform/base and itself alone";
  if (to == Room::kSlamKernels) return {};
  if (from == Room::kSlamExchange) {
    if (to == Room::kSlamCommon || is_plain_slam_type(path)) return {};
    return "slam/exchange includes plain types of slam alone";
  }
  if (to == Room::kSlamExchange)
    return "the core knows no network: nothing in slam includes "
           "slam/exchange";
  if (from == Room::kSlamWhole || to == Room::kSlamCommon) return {};
  if (to == Room::kSlamWhole) return "stages are called by the step and do not include it";
  switch (from) {
    case Room::kSlamCommon:
      if (to == Room::kSlamImage) return {};
      return "common types of slam include no stage but slam/image";
    case Room::kSlamImage:
      return "slam/image is the first stage and includes no later one";
    case Room::kSlamFilter:
    case Room::kSlamMap:
      if (to == Room::kSlamFleet) return "slam/filter and slam/map do not include slam/fleet";
      return {};
    default:
      return {};
  }
}

Broken check_driver_include(const std::string& file, const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == Room::kLinux || is_plain_slam_type(path)) return {};
  if (to == Room::kDrivers) {
    if (driver_folder(file) == driver_folder(path)) return {};
    return "drivers never include each other's folders";
  }
  return "drivers include platform/base, platform/linux and plain types of slam alone";
}

bool is_daemon(Room room) {
  return room == Room::kDaemon || room == Room::kDaemonSimulated;
}

Broken check_config_include(const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == Room::kLinux || to == Room::kConfig || is_plain_slam_type(path) ||
      path == "drivers/odometry/wheel_codec_config.h") {
    return {};
  }
  return "platform/config includes platform/base, platform/linux, plain types of slam and the "
         "codecs' table alone";
}

Broken check_recording_include(const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == Room::kLinux || to == Room::kConfig || to == Room::kRecording ||
      is_plain_slam_type(path) || starts_with(path, "drivers/odometry/")) {
    return {};
  }
  return "platform/recording includes platform/base, platform/linux, platform/config, plain types "
         "of slam and drivers/odometry alone";
}

Broken check_link_include(const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == Room::kLinux || to == Room::kLink || is_plain_slam_type(path) ||
      starts_with(path, "slam/exchange/")) {
    return {};
  }
  return "platform/link includes platform/base, platform/linux, slam/exchange and plain types of "
         "slam alone";
}

Broken check_storage_include(const std::string& path) {
  const Room to = room_of(path);
  if (to == Room::kBase || to == Room::kLinux || to == Room::kStorage || is_plain_slam_type(path) ||
      starts_with(path, "slam/exchange/")) {
    return {};
  }
  return "platform/storage includes platform/base, platform/linux, slam/exchange and plain types "
         "of "
         "slam alone";
}

Broken check_project_include(const std::string& file, const std::string& path) {
  const Room from = room_of(file);
  const Room to = room_of(path);
  if (to == Room::kUnknown) return "quoted includes name a file from the root of the sources";
  if (from == Room::kTests) return {};
  if (to == Room::kTests) return "only tests include tests";
  if (to == Room::kTools && from != Room::kTools) return "only tools and tests include tools";
  if (to == Room::kSim && from != Room::kSim && from != Room::kTools &&
      from != Room::kDaemonSimulated) {
    return "only sim, tools, platform/daemon/simulated and tests include sim";
  }
  if (to == Room::kRecording && (from == Room::kDaemon || from == Room::kSim)) {
    return "zenithd reads no recordings: its lean link has no PNG and no YAML";
  }
  if (is_daemon(to) && !is_daemon(from) && from != Room::kTools) {
    return "nothing includes platform/daemon but itself, tools and tests";
  }
  if (to == Room::kDaemonSimulated && from == Room::kDaemon) {
    return "zenithd is built without the simulator";
  }
  if (from == Room::kBase) {
    if (to == Room::kBase) return {};
    return "platform/base includes the standard library alone";
  }
  if (is_slam(from)) return check_slam_include(from, path);
  if (from == Room::kDrivers) return check_driver_include(file, path);
  if (from == Room::kRecording) return check_recording_include(path);
  if (from == Room::kConfig) return check_config_include(path);
  if (from == Room::kLink) return check_link_include(path);
  if (from == Room::kStorage) return check_storage_include(path);
  if (from == Room::kLinux) {
    if (to == Room::kBase || to == Room::kLinux || is_plain_slam_type(path)) return {};
    return "platform/linux includes platform/base and plain types of slam alone";
  }
  return {};
}

// Standard headers have neither a folder nor an ending.
bool is_standard(std::string_view header) {
  return header.find_first_of("./") == std::string_view::npos;
}

// What each instruction set's kernels need; they are no library.
bool is_intrinsics(std::string_view header) {
  return header == "immintrin.h" || header == "smmintrin.h" || header == "emmintrin.h" ||
         header == "arm_neon.h" || header == "arm_acle.h" || header == "cpuid.h";
}

// Standard headers that bring a heap, threads, clocks, files or foreign randomness.
bool is_forbidden_in_core(std::string_view header) {
  static constexpr std::array<std::string_view, 32> kForbidden = {
      "any",           "chrono",     "condition_variable",
      "cstdio",        "ctime",      "deque",
      "exception",     "filesystem", "format",
      "forward_list",  "fstream",    "functional",
      "future",        "iomanip",    "iostream",
      "istream",       "list",       "locale",
      "map",           "memory",     "mutex",
      "ostream",       "queue",      "random",
      "regex",         "set",        "sstream",
      "stack",         "string",     "thread",
      "unordered_map", "vector"};
  return std::find(kForbidden.begin(), kForbidden.end(), header) != kForbidden.end();
}

Broken check_system_include(const std::string& file, const std::string& header) {
  const Room from = room_of(file);
  if (from == Room::kBase && !is_standard(header)) {
    return "platform/base includes the standard library alone";
  }
  if (is_slam(from)) {
    if (!is_standard(header) && !is_intrinsics(header) && !starts_with(header, "Eigen/")) {
      return "slam includes platform/base, Eigen and the standard library alone";
    }
    if (is_forbidden_in_core(header)) {
      return "slam has no heap, no thread, no clock and no stream: <" + header + ">";
    }
  }
  const bool may_opencv = from == Room::kSim || from == Room::kTools || from == Room::kTests;
  if (header == "sodium.h" && from != Room::kLink && from != Room::kTests) {
    return "only platform/link uses libsodium";
  }
  if (from == Room::kLink &&
      (header == "sys/socket.h" || header == "ctime" || header == "poll.h")) {
    return "platform/link has no socket and no clock: datagrams and time are arguments";
  }
  if (starts_with(header, "opencv") && !may_opencv) return "only sim, tools and tests use OpenCV";
  return {};
}

struct ForbiddenText {
  std::regex pattern;
  const char* rule;
};

const std::vector<ForbiddenText>& forbidden_in_core() {
  static const std::vector<ForbiddenText> kList = [] {
    std::vector<ForbiddenText> list;
    const auto add = [&list](const char* pattern, const char* rule) {
      list.push_back({std::regex(pattern), rule});
    };
    add(R"(\b(malloc|calloc|realloc|aligned_alloc|posix_memalign|strdup)\s*\()",
        "slam allocates nothing: its memory comes from the caller");
    add(R"(\bnew\b(?!\s*\()|\bnew\s*\(\s*std::nothrow)",
        "slam allocates nothing: only placement new into the caller's memory");
    add(R"((^|[^=\s])\s*\bdelete\b|\bfree\s*\()", "slam frees nothing");
    add(R"(\bstd::(vector|string|deque|list|map|set|unordered_\w+|function|any|unique_ptr|)"
        R"(shared_ptr|make_unique|make_shared|pmr)\b)",
        "slam has fixed containers alone");
    add(R"(\bEigen::(Matrix|Vector|RowVector|Array)(\dX|X\d?)[a-z]+\b|\bEigen::Dynamic\b)",
        "slam has Eigen types of fixed size alone");
    add(R"(\bstd::(thread|jthread|async|mutex|condition_variable)\b|\bpthread_\w+)",
        "slam has no thread and no lock");
    add(R"(\bstd::chrono\b|\b(clock_gettime|gettimeofday|nanosleep|usleep)\s*\(|\btime\s*\(\s*)"
        R"((nullptr|NULL|0|&))",
        "slam reads no clock: time is an argument");
    add(R"(\bstd::(cout|cerr|clog)\b|\b(f|s|sn)?printf\s*\(|\b(fopen|open|read|write)\s*\()",
        "slam writes and reads nothing");
    add(R"(\b(rand|srand|drand48)\s*\(|\bstd::(random_device|mt19937)\b)",
        "slam takes its randomness from platform/base/random.h");
    return list;
  }();
  return kList;
}

const std::vector<ForbiddenText>& forbidden_without_exceptions() {
  static const std::vector<ForbiddenText> kList = [] {
    std::vector<ForbiddenText> list;
    list.push_back({std::regex(R"(\b(throw|try|catch)\b)"), "errors are values: no exceptions"});
    list.push_back({std::regex(R"(\b(dynamic_cast|typeid)\b)"), "no RTTI"});
    return list;
  }();
  return kList;
}

// How files are read that anything may stand in.
const std::vector<ForbiddenText>& forbidden_readers() {
  static const std::vector<ForbiddenText> kList = {
      {std::regex(R"(\bstd::i?fstream\b|\btoml::parse_file\b|\bYAML::LoadFile|)"
                  R"(\bcv::(imread\w*|haveImageReader|FileStorage)\b)"),
       "files are read through platform/linux/input_file.h, which bounds them"}};
  return kList;
}

bool has_no_exceptions(Room room) {
  return is_slam(room) || room == Room::kDrivers || room == Room::kBase || room == Room::kLinux ||
         room == Room::kConfig || room == Room::kLink || room == Room::kStorage;
}

Broken check_include_line(const std::string& file, const std::string& line) {
  static const std::regex kQuoted(R"(^\s*#\s*include\s*"([^"]+)\")");
  static const std::regex kAngled(R"(^\s*#\s*include\s*<([^>]+)>)");
  std::smatch match;
  if (std::regex_search(line, match, kQuoted)) return check_project_include(file, match[1]);
  if (std::regex_search(line, match, kAngled)) return check_system_include(file, match[1]);
  return {};
}

}  // namespace

std::string Violation::text() const {
  return file + ":" + std::to_string(line) + ": " + rule;
}

std::vector<Violation> check_architecture(const std::string& file, std::string_view source) {
  std::vector<Violation> violations;
  const Room room = room_of(file);
  std::istringstream lines(strip_comments_and_literals(source));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (const Broken broken = check_include_line(file, line)) {
      violations.push_back({file, number, *broken});
    }
    if (line.find("include") != std::string::npos) continue;
    const auto check = [&](const std::vector<ForbiddenText>& list) {
      for (const ForbiddenText& forbidden : list) {
        if (!std::regex_search(line, forbidden.pattern)) continue;
        violations.push_back({file, number, forbidden.rule});
      }
    };
    if (is_slam(room)) check(forbidden_in_core());
    const bool own_bounds = file == "tools/view/timeline.cpp";
    if (room != Room::kTests && !own_bounds) check(forbidden_readers());
    if (has_no_exceptions(room)) check(forbidden_without_exceptions());
  }
  return violations;
}

}  // namespace zenith
