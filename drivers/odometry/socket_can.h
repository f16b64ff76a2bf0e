#pragma once
// A CAN bus of the kernel: a raw SocketCAN socket on one interface, classic frames.
//
// The kernel filters by identifier, so that a busy bus costs nothing. Bitrate, restart after
// bus-off and the interface's state are systemd-networkd's business; this bus only listens, and
// tells. Stamps: can_stamps.h.
//
// Bus-off is known from the controller's error frames; the bus counts as back when the controller
// says so, or when a frame comes. One receive() reads at most as many error frames, and frames that
// are none for us, as kMaxOther: a flood of them cannot hold the caller up.

#include <cstdint>
#include <string>

#include "drivers/odometry/can_bus.h"
#include "drivers/odometry/can_io.h"
#include "drivers/odometry/can_stamps.h"

namespace zenith {

struct SocketCanSettings {
  std::string interface = "can0";
  CanIds ids;  // of the frames that are delivered; empty: all
};

class SocketCanBus final : public CanBus {
 public:
  static constexpr int kMaxOther = 64;

  // `io` must outlive the bus.
  explicit SocketCanBus(const SocketCanSettings& settings, CanIo& io = kernel_can_io())
      : settings_(settings), io_(io) {}
  ~SocketCanBus() override { SocketCanBus::close(); }

  // Looks the interface up anew each time. One that is missing or down is an error.
  Status open() override;
  void close() override;
  std::size_t receive(Duration timeout, std::span<CanFrame> out) override;

  CanState state() const override { return state_; }
  const char* lost_reason() const override { return lost_reason_; }
  std::string description() const override;
  const CanCounters& counters() const override { return counters_; }

 private:
  Status start();
  Status set_options();
  std::size_t take(std::span<CanFrame> out);
  bool accept(const CanDatagram& datagram, CanFrame& out);
  void note_drops(std::uint32_t sum);
  void note_error_frame(const can_frame& frame);
  void come_back();
  void lose(int error);

  const SocketCanSettings settings_;
  CanIo& io_;
  int fd_ = -1;
  CanState state_ = CanState::kClosed;
  const char* lost_reason_ = "";
  CanStamps stamps_;
  std::uint32_t drops_seen_ = 0;
  CanCounters counters_;
};

}  // namespace zenith
