// hil-play, in a guest: writes a play's pictures into a V4L2 output device, one write() each, in
// step with the play's CAN log.
//
// Until the first CAN frame comes on the bus it writes the first picture again and again, so that
// the camera is there and the robot stands. That frame, which canplayer sends, begins the play.
// Pictures are stamped by the kernel when they are written: one that is late is left out, for its
// stamp would be wrong. After the last one, the last one is repeated until SIGTERM or SIGINT.

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/videodev2.h>
#include <net/if.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/unique_fd.h"

namespace zenith::hil {
namespace {

constexpr Duration kRepeat = {500'000'000};  // of a picture while the robot stands
constexpr Duration kLate = {30'000'000};

volatile sig_atomic_t ended = 0;

void end(int) {
  ended = 1;
}

struct Options {
  std::string play;
  std::string camera;
  std::string bus;
  std::string origin;         // file that gets the play's beginning, CLOCK_MONOTONIC nanoseconds
  bool sends_can = false;     // sends the log itself, by CLOCK_MONOTONIC: the wall clock may jump
  std::int64_t since_ns = 0;  // not 0: goes on with a play that began then
};

struct Pictures {
  std::vector<char> all;  // in memory: the host's folder may take its time
  std::size_t bytes = 0;  // of one
  int width = 0;
  int height = 0;
  std::vector<std::int64_t> times_ns;

  const char* at(std::size_t index) const { return all.data() + index * bytes; }
};

Error failed(const std::string& what) {
  return Error{what + ": " + errno_text(errno)};
}

Result<Pictures> open_pictures(const std::string& play) {
  Pictures pictures;
  std::ifstream in(play + "/frames.txt");
  std::size_t count = 0;
  in >> pictures.width >> pictures.height >> count;
  pictures.times_ns.resize(count);
  for (std::int64_t& time : pictures.times_ns) in >> time;
  if (!in || count == 0) return Error{play + "/frames.txt is no list of pictures; see hil-cut"};
  pictures.bytes = static_cast<std::size_t>(pictures.width) * pictures.height;
  pictures.all.resize(pictures.bytes * count);
  std::ifstream pixels(play + "/frames.grey", std::ios::binary);
  if (!pixels.read(pictures.all.data(), static_cast<std::streamsize>(pictures.all.size()))) {
    return Error{play + "/frames.grey is shorter than frames.txt says; see hil-cut"};
  }
  return pictures;
}

Result<UniqueFd> open_camera(const std::string& path, const Pictures& pictures) {
  UniqueFd fd(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!fd.is_open()) return failed("cannot open " + path);
  v4l2_format format = {};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = static_cast<std::uint32_t>(pictures.width);
  format.fmt.pix.height = static_cast<std::uint32_t>(pictures.height);
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.bytesperline = format.fmt.pix.width;
  format.fmt.pix.sizeimage = static_cast<std::uint32_t>(pictures.bytes);
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (::ioctl(fd.get(), VIDIOC_S_FMT, &format) != 0) return failed(path + " refuses the format");
  if (format.fmt.pix.pixelformat != V4L2_PIX_FMT_GREY ||
      format.fmt.pix.sizeimage != pictures.bytes) {
    return Error{path + " took another format than GREY of the pictures' size"};
  }
  return fd;
}

Result<UniqueFd> open_bus(const std::string& name) {
  UniqueFd fd(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!fd.is_open()) return failed("no CAN socket");
  sockaddr_can address = {};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(name.c_str()));
  if (address.can_ifindex == 0) return failed("there is no CAN interface " + name);
  if (::bind(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    return failed("cannot listen on " + name);
  }
  return fd;
}

// Frames of the log with their times since the first one, for Options::sends_can.
struct LoggedFrame {
  std::int64_t time_ns = 0;
  can_frame frame = {};
};

std::vector<LoggedFrame> read_log(const std::string& path) {
  std::vector<LoggedFrame> frames;
  std::ifstream in(path);
  std::string line;
  std::int64_t first_ns = 0;
  while (std::getline(in, line)) {
    long long seconds = 0, microseconds = 0;
    unsigned id = 0;
    char data[17] = {};
    if (std::sscanf(line.c_str(), "(%lld.%lld) %*s %x#%16s", &seconds, &microseconds, &id, data) <
        4) {
      continue;
    }
    LoggedFrame logged;
    logged.time_ns = (seconds * 1'000'000 + microseconds) * 1000;
    if (frames.empty()) first_ns = logged.time_ns;
    logged.time_ns -= first_ns;
    logged.frame.can_id = id;
    logged.frame.can_dlc = static_cast<__u8>(std::strlen(data) / 2);
    for (int i = 0; i < logged.frame.can_dlc; ++i) {
      const std::string byte(data + 2 * i, 2);
      logged.frame.data[i] = static_cast<__u8>(std::strtoul(byte.c_str(), nullptr, 16));
    }
    frames.push_back(logged);
  }
  return frames;
}

class Player {
 public:
  Player(Pictures pictures, UniqueFd camera, UniqueFd bus, std::vector<LoggedFrame> log)
      : pictures_(std::move(pictures)),
        camera_(std::move(camera)),
        bus_(std::move(bus)),
        log_(std::move(log)) {}

  // False when it was ended meanwhile.
  Result<bool> stand_until_the_bus_speaks(Time& origin) {
    shown_now_ = pictures_.at(0);
    for (Time repeat = monotonic_now(); !ended;) {
      if (const Status shown = show(); !shown) return shown.error();
      repeat = repeat + kRepeat;
      pollfd waits = {bus_.get(), POLLIN, 0};
      const Duration left = repeat - monotonic_now();
      const int ready = ::poll(&waits, 1, static_cast<int>(left.ns > 0 ? left.ns / 1'000'000 : 0));
      can_frame frame;
      if (ready > 0 && ::read(bus_.get(), &frame, sizeof frame) == sizeof frame) {
        origin = monotonic_now();
        return true;
      }
    }
    return false;
  }

  Status play(Time origin) {
    for (std::size_t i = 0; i < pictures_.times_ns.size() && !ended; ++i) {
      const Time due = origin + Duration{pictures_.times_ns[i]};
      if (monotonic_now() > due + kLate) {
        ++late_;
        continue;
      }
      shown_now_ = pictures_.at(i);
      wait_and_send(due, origin);
      if (monotonic_now() > due + kLate) {
        ++late_;
        continue;
      }
      if (const Status shown = show(); !shown) return shown;
      ++shown_;
    }
    std::printf("play: %d pictures shown, %d left out because they were late\n", shown_, late_);
    std::fflush(stdout);
    shown_now_ = pictures_.at(pictures_.times_ns.size() - 1);
    return {};
  }

  Status stand(Time origin) {
    for (Time repeat = monotonic_now(); !ended; repeat = repeat + kRepeat) {
      if (const Status shown = show(); !shown) return shown;
      wait_and_send(repeat + kRepeat, origin);
    }
    return {};
  }

  bool has_log() const { return !log_.empty(); }

 private:
  Status show() {
    for (int tries = 0;; ++tries) {
      const ssize_t written = ::write(camera_.get(), shown_now_, pictures_.bytes);
      if (written == static_cast<ssize_t>(pictures_.bytes)) return {};
      if (written < 0 && (errno == EINTR || errno == EAGAIN) && tries < 100 && !ended) continue;
      return ended ? Status{} : Status{failed("the camera does not take a picture")};
    }
  }

  // Sleeps until then, and sends what is due of the log meanwhile; after its end the last frame
  // twenty times a second.
  void wait_and_send(Time until, Time origin) {
    while (!log_.empty() && !ended) {
      const Time due = next_frame_ < log_.size() ? origin + Duration{log_[next_frame_].time_ns}
                                                 : last_sent_ + Duration{50'000'000};
      if (due > until) break;
      sleep_until(due);
      const std::size_t index = std::min(next_frame_, log_.size() - 1);
      // An interface that is down takes nothing: that is what some scenarios are about.
      if (::write(bus_.get(), &log_[index].frame, sizeof(can_frame)) < 0) ++unsent_;
      if (next_frame_ < log_.size()) ++next_frame_;
      last_sent_ = monotonic_now();
    }
    sleep_until(until);
  }

  Pictures pictures_;
  UniqueFd camera_;
  UniqueFd bus_;
  std::vector<LoggedFrame> log_;
  const char* shown_now_ = nullptr;
  std::size_t next_frame_ = 0;
  Time last_sent_;
  int shown_ = 0;
  int late_ = 0;
  int unsent_ = 0;
};

Status run(const Options& options) {
  auto pictures = open_pictures(options.play);
  if (!pictures) return pictures.error();
  auto camera = open_camera(options.camera, *pictures);
  if (!camera) return camera.error();
  auto bus = open_bus(options.bus);
  if (!bus) return bus.error();
  std::vector<LoggedFrame> log;
  if (options.sends_can) log = read_log(options.play + "/can0.log");
  Player player(std::move(*pictures), std::move(*camera), std::move(*bus), std::move(log));
  Time origin = {options.since_ns};
  if (options.since_ns == 0) {
    const auto begun = player.stand_until_the_bus_speaks(origin);
    if (!begun) return begun.error();
    if (!*begun) return {};
    const std::string unfinished = options.origin + ".new";
    std::ofstream(unfinished) << origin.ns << "\n";
    std::rename(unfinished.c_str(), options.origin.c_str());
  }
  const Status played = player.play(origin);
  return played ? player.stand(origin) : played;
}

bool read_options(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--camera" && has_value) {
      options.camera = argv[++i];
    } else if (word == "--bus" && has_value) {
      options.bus = argv[++i];
    } else if (word == "--origin" && has_value) {
      options.origin = argv[++i];
    } else if (word == "--since" && has_value) {
      options.since_ns = std::atoll(argv[++i]);
    } else if (word == "--send-can") {
      options.sends_can = true;
    } else if (options.play.empty() && word[0] != '-') {
      options.play = word;
    } else {
      return false;
    }
  }
  return !options.play.empty() && !options.camera.empty() && !options.bus.empty() &&
         !options.origin.empty();
}

}  // namespace
}  // namespace zenith::hil

int main(int argc, char** argv) {
  zenith::hil::Options options;
  if (!zenith::hil::read_options(argc, argv, options)) {
    std::fprintf(
        stderr,
        "Usage: hil-play PLAY --camera /dev/videoN --bus vcanN --origin FILE\n"
        "                [--since NS] [--send-can]\n\n"
        "The first frame on the bus begins the play; FILE gets when that was. --since goes\n"
        "on with a play that began then. --send-can sends the CAN log, too, by a clock\n"
        "that nobody sets; the first frame on the bus begins it all the same.\n");
    return 2;
  }
  struct sigaction action = {};
  action.sa_handler = zenith::hil::end;
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  const zenith::Status done = zenith::hil::run(options);
  if (!done) std::fprintf(stderr, "hil-play: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
