// zenith record: the running robot, or its devices, as a recording.

#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

#include "platform/daemon/simulated/simulated_devices.h"
#include "platform/linux/clock.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/printable_output.h"
#include "platform/linux/signals.h"
#include "tools/commands.h"
#include "tools/record/record.h"
#include "tools/record/running_daemon.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Records what the running zenithd sees: its frames, the wheels' CAN frames and the poses that
it estimates, as a folder that `zenith replay` reads. The robot goes on as if nobody listened: what
the recorder is too slow for is left out of the recording, counted, and told at the end.

Ctrl-C ends it. The folder can be read at any moment; after a crash or on a full disk there is what
was recorded until then. The daemon lets its own user and root record, one at a time.

Without a daemon, --config FILE opens the camera and the CAN bus that the file names: for drives
that calibrate the camera, before there is anything to map with.

Examples:
  sudo zenith record rec/anna                       until Ctrl-C
  sudo zenith record rec/anna --duration 60
  zenith record rec/anna --socket /run/zenith/record.sock --max-size 500
  zenith record rec/drive --config zenith.toml      no daemon may be running
  zenith replay rec/anna --out out                  map it

docs/recording.md explains more.)";

struct RecordCommand {
  RecordPlan plan;
  std::string out;
  std::string socket;
  std::string config;
};

// One line on stderr: rewritten on a terminal, else a new one every ten seconds.
class StatusLine {
 public:
  StatusLine() : terminal_(::isatty(STDERR_FILENO) == 1), next_(monotonic_now() + pause()) {}
  ~StatusLine() {
    if (terminal_ && shown_) std::fputc('\n', stderr);
  }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void show(const RecordFigures& f) {
    const Time now = monotonic_now();
    if (now < next_) return;
    next_ = now + pause();
    const double rate = f.seconds > 0.0 ? static_cast<double>(f.frames) / f.seconds : 0.0;
    char line[200];
    std::snprintf(
        line, sizeof line,
        "%s%6.1f s  %llu frames (%.1f/s)  %llu CAN  %.1f MB  %llu left out  %.1f GB free%s",
        terminal_ ? "\r" : "", f.seconds, static_cast<unsigned long long>(f.frames), rate,
        static_cast<unsigned long long>(f.can), static_cast<double>(f.bytes) * 1e-6,
        static_cast<unsigned long long>(f.left_out), f.free_mb * 1e-3, terminal_ ? "  " : "\n");
    write_to_terminal(line);
    shown_ = true;
  }

 private:
  Duration pause() const { return {terminal_ ? 250'000'000 : 10'000'000'000}; }

  const bool terminal_;
  bool shown_ = false;
  Time next_;
};

Result<std::unique_ptr<RecordSource>> open_devices(const std::string& file) {
  const auto config = read_daemon_config(file);
  if (!config) return config.error();
  if (const std::string running = find_running_daemon(*config); !running.empty()) {
    return Error{"zenithd is running (it listens at " + running +
                 ") and has the camera: record from it, without --config, or stop it first"};
  }
  auto devices = make_any_devices(*config);
  if (!devices) return devices.error();
  return open_device_source(*config, std::move(*devices));
}

// One that is named may also be a path from here.
std::vector<std::string> socket_paths(const std::string& named) {
  if (named.empty()) return runtime_paths(RecordConfig{}.socket);
  if (named.find('/') != std::string::npos) return {named};
  return runtime_paths(named);
}

int run_record(RecordCommand& command) {
  command.plan.out = command.out;
  if (const Status free = check_record_target(command.out); !free) return fail(free.error());
  Signals signals;
  if (const Status opened = signals.open(); !opened) return fail(opened.error());
  const bool direct = !command.config.empty();
  // A camera does not wait for the disk, as a daemon's tap does.
  if (direct) command.plan.patience = {0};
  auto source =
      direct ? open_devices(command.config) : open_tap_source(socket_paths(command.socket));
  if (!source) return fail(source.error());
  std::fprintf(stderr, "recording %s\n", (*source)->description().c_str());
  const auto figures = [&] {
    StatusLine line;
    return record(
        command.plan, **source, [&signals] { return signals.wait({0}) == SignalRequest::kStop; },
        [&line](const RecordFigures& f) { line.show(f); });
  }();
  if (!figures) return fail(figures.error());
  const std::string summary = record_summary(command.plan, *figures);
  std::printf("%s", summary.c_str());
  return figures->failed || figures->frames == 0 ? 1 : 0;
}

}  // namespace

void add_record_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<RecordCommand>();
  RecordPlan& plan = command->plan;
  CLI::App* record = app.add_subcommand("record", "Record the running robot");
  record->footer(kHelp);
  record->add_option("OUT", command->out, "the folder to write; it must not exist")->required();
  CLI::Option* socket = record->add_option(
      "--socket", command->socket,
      "the daemon's record.socket; without it the usual places are looked through");
  record->add_option("--config", command->config, "open the devices of this configuration")
      ->excludes(socket);
  record->add_option("--duration", plan.duration_s, "seconds, 0: until Ctrl-C")
      ->check(CLI::NonNegativeNumber);
  record->add_option("--max-size", plan.max_size_mb, "MB, 0: no limit but the disk's")
      ->check(CLI::NonNegativeNumber);
  record->add_option("--keep-free", plan.keep_free_mb, "MB of the disk that are left to others")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  record
      ->add_option("--compression", plan.compression,
                   "of the frames: 0 none, 1 quick, 9 slow and a little smaller")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  record->add_option("--threads", plan.threads, "that compress frames")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  record->callback([command, &exit_code] { exit_code = run_record(*command); });
}

}  // namespace zenith::tools
