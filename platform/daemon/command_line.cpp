// The program around run_daemon(): arguments, and what is answered without running.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "platform/config/lens_settings.h"
#include "platform/config/robot_settings.h"
#include "platform/daemon/config_text.h"
#include "platform/daemon/daemon.h"
#include "platform/daemon/map_keeper.h"
#include "platform/daemon/memory_report.h"
#include "platform/daemon/version.h"
#include "platform/link/fleet_key.h"
#include "platform/linux/clock.h"
#include "platform/linux/cpu.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/log.h"
#include "platform/linux/printable_output.h"
#include "platform/linux/realtime.h"
#include "platform/linux/signals.h"
#include "slam/kernels/isa_in_use.h"

namespace zenith {
namespace {

constexpr const char* kHelp =
    R"(Maps the ceiling with one camera and wheel odometry, as a service on the robot.

Usage:
  %s --config FILE           run until SIGTERM or SIGINT
  %s --config FILE --check   say what is wrong with the file, or what would be done
  %s --print-config          every key with its default: a file to start from
  %s --print-reference       the same as docs/configuration.md
  %s --version, --help

A first file:
  zenithd --print-config > zenith.toml    then set [camera], [lens], [mount], [wheels], [odometry]
  zenithd --config zenith.toml --check

Without a robot: zenithd-sim --config config/simulated.toml is the same program with a simulated
camera and CAN bus.

Signals: SIGHUP reads the file again and takes over what may change while running, and the fleet's
key; a file with a mistake changes nothing and the log says what is wrong. SIGTERM and SIGINT end
the program as soon as the map is on the disk, mostly within a second. Others that would end it,
such as SIGUSR1 and SIGALRM, are ignored; SIGQUIT and those of faults are not.

It tells how it is on standard error (journald's levels when started by systemd), on LEDs, and on
a local socket, a line of JSON each:
  socat -u UNIX-CONNECT:/run/zenith/telemetry.sock,type=5 -

Environment: ZENITH_SIMD=scalar, sse4.1, avx2, avx512, neon or neon-dotprod takes kernels for that
instruction set instead of the best that the processor has. The results are the same.

Exit codes: 0 ended as asked or the file is good, 1 failed, 2 wrong arguments or configuration.
docs/daemon.md explains more, docs/configuration.md every key.
)";

struct Arguments {
  std::string config;
  bool check = false;
  bool version = false;
  bool help = false;
  bool print_config = false;
  bool print_reference = false;
};

Result<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--config" && i + 1 < argc) {
      arguments.config = argv[++i];
    } else if (word.substr(0, 9) == "--config=") {
      arguments.config = word.substr(9);
    } else if (word == "--check") {
      arguments.check = true;
    } else if (word == "--version") {
      arguments.version = true;
    } else if (word == "--help" || word == "-h") {
      arguments.help = true;
    } else if (word == "--print-config") {
      arguments.print_config = true;
    } else if (word == "--print-reference") {
      arguments.print_reference = true;
    } else if (word == "--config") {
      return Error{"--config needs a file"};
    } else {
      return Error{"unknown argument '" + std::string(word) + "'"};
    }
  }
  return arguments;
}

std::string_view base_name(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

void print_limits(const RealtimeConfig& realtime) {
  const RealtimeLimits limits = realtime_limits();
  std::printf("realtime:  SCHED_FIFO %d (this shell's limit: %llu), CPUs %s\n", realtime.priority,
              static_cast<unsigned long long>(limits.fifo_priority),
              realtime.cpus.empty() ? "any" : realtime.cpus.c_str());
  if (!realtime.lock_memory) {
    std::printf("locked:    no\n");
  } else if (limits.locked_bytes == RealtimeLimits::kUnlimited) {
    std::printf("locked:    all memory (this shell's limit: none)\n");
  } else {
    std::printf("locked:    all memory (this shell's limit: %llu KiB)\n",
                static_cast<unsigned long long>(limits.locked_bytes / 1024));
  }
}

// False, and said, when there is a key file that cannot be used: the radio would stay off.
bool print_fleet_key(const RadioConfig& radio) {
  if (!radio.enabled || radio.key_file.empty()) {
    std::printf("fleet key: none, the radio is off: %s\n",
                radio.enabled ? "radio.key_file names no key" : "radio.enabled is false");
    return true;
  }
  const auto keys = read_fleet_keys(radio.key_file);
  if (!keys) {
    std::fprintf(stderr, "%s\n", keys.error().message.c_str());
    return false;
  }
  std::printf("fleet key: %s, from %s\n", keys_text(*keys).c_str(), radio.key_file.c_str());
  return true;
}

// Where the map would be kept, and what stands against it.
void print_map_folder(const MapConfig& map) {
  const std::string folder = map_folder(map.folder, state_folder());
  if (map.folder.empty()) return (void)std::printf("map kept:  no: map.folder is empty\n");
  if (folder.empty()) {
    std::printf("map kept:  in %s of the service's state folder (STATE_DIRECTORY, not set here)\n",
                map.folder.c_str());
    return;
  }
  const storage::FolderFacts facts = storage::look_at_folder(folder);
  const bool is_made = folder != map.folder && folder != state_folder();  // make_map_folder()
  std::string text = folder;
  if (!facts.exists) {
    text += is_made ? ", to be made" : ": it is not there, so no map is kept: make it";
  } else if (!facts.is_folder) {
    text += ": it is no folder, so no map is kept: name another one";
  } else {
    text += ", of " + facts.owner + ", " + std::to_string(std::lround(facts.free_mb)) + " MB free";
    if (!facts.writable) text += "; this user cannot write it";
    if (facts.user) text += "; in use by " + storage::user_text(*facts.user);
  }
  std::printf("map kept:  %s\n", text.c_str());
}

int check(const DaemonConfig& config, MakeDevices make_devices) {
  const auto devices = make_devices(config);
  if (!devices) {
    std::fprintf(stderr, "%s\n", devices.error().message.c_str());
    return 2;
  }
  const Lens& lens = devices->robot.lens;
  std::printf("robot:     %s\n", config.name.c_str());
  std::printf("devices:   %s\n", devices->description.c_str());
  std::printf("frames:    %d x %d, %g a second\n", lens.width_px, lens.height_px,
              devices->robot.frame_rate_hz);
  if (const std::string note = lens_note(lens); !note.empty()) {
    std::printf("lens:      %s\n", note.c_str());
  }
  std::printf("view:      %s\n", view_text(config.slam, devices->robot).c_str());
  std::printf("map:       %d particles\n", config.slam.particles);
  std::printf("kernels:   %s\n", std::string(isa_name(isa_in_use())).c_str());
  print_limits(config.realtime);
  const auto socket = runtime_path(config.telemetry.socket);
  std::printf("telemetry: %s\n", !config.telemetry.enabled ? "none"
                                 : socket                  ? socket->c_str()
                                                           : socket.error().message.c_str());
  print_map_folder(config.map);
  if (!print_fleet_key(config.radio)) return 2;
  std::printf("memory of the algorithm, all of it taken at the start:\n%s",
              memory_text(daemon_memory(config)).c_str());
  std::printf("The configuration is good. Devices were not opened.\n");
  return 0;
}

int run(int argc, char** argv, MakeDevices make_devices, Signals& signals) {
  const std::string name(base_name(argv[0]));
  const auto arguments = parse(argc, argv);
  if (!arguments) {
    std::fprintf(stderr, "%s: %s; see %s --help\n", name.c_str(), arguments.error().message.c_str(),
                 name.c_str());
    return 2;
  }
  if (arguments->help) {
    const char* n = name.c_str();
    std::printf(kHelp, n, n, n, n, n);
    return 0;
  }
  if (arguments->version) return std::printf("%s %s\n", name.c_str(), kVersion) > 0 ? 0 : 1;
  if (arguments->print_config) return std::fputs(annotated_config().c_str(), stdout) < 0 ? 1 : 0;
  if (arguments->print_reference) return std::fputs(config_reference().c_str(), stdout) < 0 ? 1 : 0;
  if (arguments->config.empty()) {
    std::fprintf(stderr, "%s: --config FILE is missing; see %s --help\n", name.c_str(),
                 name.c_str());
    return 2;
  }
  const auto isa = choose_isa(std::getenv("ZENITH_SIMD"));
  if (!isa) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), isa.error().message.c_str());
    return 2;
  }
  use_isa(*isa);
  const auto config = read_daemon_config(arguments->config);
  if (!config) {
    std::fprintf(stderr, "%s\n", config.error().message.c_str());
    return 2;
  }
  if (arguments->check) return check(*config, make_devices);
  return run_daemon(*config, arguments->config, make_devices, signals);
}

}  // namespace

int daemon_main(int argc, char** argv, MakeDevices make_devices) {
  make_output_printable();  // first, for it takes the numbers of closed standard files
  Signals signals;
  const Status opened = signals.open(SignalRequest::kReload);
  pin_heap();
  if (!opened) {
    std::fprintf(stderr, "zenithd: error: %s\n", opened.error().message.c_str());
    return 1;
  }
  try {
    return run(argc, argv, make_devices, signals);
  } catch (const std::exception& error) {
    process_log().drain(monotonic_now());  // what was said before it
    std::fprintf(stderr, "zenithd: error: %s\n", error.what());
    return 1;
  }
}

}  // namespace zenith
