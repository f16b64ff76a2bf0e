#include "drivers/odometry/socket_can.h"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

std::string advice(int error) {
  switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
      return "; the kernel has no raw CAN sockets: `modprobe can_raw`";
    case EPERM:
    case EACCES:
      return "; allow AF_CAN in the unit (RestrictAddressFamilies=)";
    default:
      return "";
  }
}

std::string list_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

const char* loss_of(int error) {
  switch (error) {
    case ENETDOWN:
      return "the interface went down (ENETDOWN)";
    case ENODEV:
    case ENXIO:
      return "the interface is gone (ENODEV)";
    default:
      return "the socket reported an error";
  }
}

// Frames with exactly this identifier; remote frames do not pass.
can_filter filter_of(const CanId& id) {
  const canid_t flags = CAN_EFF_FLAG | CAN_RTR_FLAG;
  if (id.extended) return {id.id | CAN_EFF_FLAG, flags | CAN_EFF_MASK};
  return {id.id, flags | CAN_SFF_MASK};
}

}  // namespace

Status SocketCanBus::open() {
  close();
  Status status = start();
  if (!status) close();
  return status;
}

Status SocketCanBus::start() {
  const std::string& name = settings_.interface;
  if (name.empty() || name.size() >= IFNAMSIZ) {
    return Error{"'" + name + "' is no name of a CAN interface: expected 1 to 15 characters"};
  }
  const int index = io_.index_of(name.c_str());
  if (index < 0) {
    return Error{"CAN interface " + name + ": there is none of this name; CAN interfaces: " +
                 list_text(io_.list()) + ". Is the adapter plugged in, its driver loaded?"};
  }
  fd_ = io_.open();
  if (fd_ < 0) return Error{"CAN socket: " + errno_text(-fd_) + advice(-fd_)};
  Status options = set_options();
  if (!options) return options;
  const int bound = io_.bind(fd_, index);
  if (bound < 0) {
    return Error{"CAN interface " + name + ": " + errno_text(-bound) +
                 (bound == -ENODEV
                      ? "; it is no CAN interface. CAN interfaces: " + list_text(io_.list())
                      : std::string())};
  }
  const int up = io_.is_up(fd_, name.c_str());
  if (up < 0) return Error{"CAN interface " + name + ": " + errno_text(-up)};
  if (up == 0) {
    return Error{"CAN interface " + name + " is down; systemd-networkd brings it up ([CAN] " +
                 "BitRate=), or by hand: `ip link set " + name + " up type can bitrate ...`"};
  }
  state_ = CanState::kUp;
  lost_reason_ = "";
  drops_seen_ = 0;
  stamps_.seen_empty(io_.now());
  ++counters_.opened;
  return {};
}

Status SocketCanBus::set_options() {
  std::array<can_filter, CanIds::capacity()> filters = {};
  for (std::size_t i = 0; i < settings_.ids.size(); ++i) filters[i] = filter_of(settings_.ids[i]);
  const can_filter all = {0, 0};
  const bool filtered = !settings_.ids.empty();
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  const struct {
    int level;
    int option;
    const void* value;
    std::size_t bytes;
    const char* what;
  } options[] = {
      {SOL_CAN_RAW, CAN_RAW_FILTER, filtered ? filters.data() : &all,
       (filtered ? settings_.ids.size() : 1) * sizeof(can_filter), "the filter of identifiers"},
      {SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors, "error frames"},
      {SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on, "reception stamps"},
      {SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on, "the count of dropped frames"},
  };
  for (const auto& option : options) {
    const int set = io_.set_option(fd_, option.level, option.option, option.value, option.bytes);
    if (set < 0) {
      return Error{"CAN socket: the kernel refuses " + std::string(option.what) + ": " +
                   errno_text(-set) + "; Linux 5.10 or later is expected"};
    }
  }
  return {};
}

void SocketCanBus::close() {
  if (fd_ >= 0) io_.close(fd_);
  fd_ = -1;
  state_ = CanState::kClosed;
}

std::size_t SocketCanBus::receive(Duration timeout, std::span<CanFrame> out) {
  if (fd_ < 0 || state_ == CanState::kDown || out.empty()) return 0;
  const Time deadline = can_deadline(io_.now(), timeout);
  for (int events = 0;;) {
    const std::size_t taken = take(out);
    if (taken > 0 || state_ == CanState::kDown) return taken;
    // What poll() reports, the socket should have told when it was read.
    if ((events & (POLLERR | POLLHUP | POLLNVAL)) != 0) break;
    const Time now = io_.now();
    if (now >= deadline) return 0;
    events = io_.poll(fd_, deadline - now);
    if (events < 0) break;
  }
  lose(EIO);
  return 0;
}

// What is there now, without waiting.
std::size_t SocketCanBus::take(std::span<CanFrame> out) {
  std::size_t taken = 0;
  int others = 0;
  while (taken < out.size() && others < kMaxOther) {
    CanDatagram datagram;
    const Time before = io_.now();
    const int result = io_.receive(fd_, datagram);
    if (result == -EAGAIN) {
      stamps_.seen_empty(before);
      break;
    }
    if (result < 0) {
      lose(-result);
      break;
    }
    if (datagram.drops_sum) note_drops(*datagram.drops_sum);
    if (accept(datagram, out[taken])) {
      ++taken;
    } else {
      ++others;
    }
  }
  counters_.frames += taken;
  return taken;
}

// False for all that is no data frame.
bool SocketCanBus::accept(const CanDatagram& datagram, CanFrame& out) {
  const can_frame& frame = datagram.frame;
  if (datagram.bytes < CAN_MTU) {
    ++counters_.ignored;
    return false;
  }
  if ((frame.can_id & CAN_ERR_FLAG) != 0) {
    note_error_frame(frame);
    return false;
  }
  if ((frame.can_id & CAN_RTR_FLAG) != 0 || frame.can_dlc > CAN_MAX_DLEN) {
    ++counters_.ignored;
    return false;
  }
  if (state_ == CanState::kBusOff) come_back();
  const CanClocks clocks = io_.clocks();
  const CanStamps::Judged judged =
      stamps_.judge(datagram.stamp_ns, clocks.monotonic, clocks.realtime_ns);
  if (judged.replaced) ++counters_.stamps_replaced;
  out = {};
  out.stamp = judged.stamp;
  out.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  out.id = frame.can_id & (out.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  out.length = frame.can_dlc;
  std::copy_n(frame.data, frame.can_dlc, out.data.begin());
  return true;
}

void SocketCanBus::note_drops(std::uint32_t sum) {
  counters_.dropped += static_cast<std::uint32_t>(sum - drops_seen_);
  drops_seen_ = sum;
}

void SocketCanBus::note_error_frame(const can_frame& frame) {
  ++counters_.error_frames;
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0 && state_ == CanState::kUp) {
    state_ = CanState::kBusOff;
    ++counters_.bus_off;
  }
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0 && state_ == CanState::kBusOff) come_back();
}

void SocketCanBus::come_back() {
  state_ = CanState::kUp;
  ++counters_.restarted;
}

void SocketCanBus::lose(int error) {
  state_ = CanState::kDown;
  lost_reason_ = loss_of(error);
  ++counters_.lost;
}

std::string SocketCanBus::description() const {
  const std::size_t count = settings_.ids.size();
  return "SocketCAN " + settings_.interface +
         (count == 0 ? ", all identifiers" : ", " + std::to_string(count) + " identifiers");
}

}  // namespace zenith
