#pragma once
// V4L2 devices that exist in memory only, on a clock that moves only when somebody waits.
//
// Each stands in for the kernel's side of one device: formats, controls, buffers, frames on a fixed
// grid of time, and all that goes wrong with them. Frame n is filled with the grey value
// (first_value + n) mod 256, n counting all frames since the stream's start, lost ones too.

#include <linux/videodev2.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/camera/v4l2_io.h"
#include "drivers/camera/v4l2_offer.h"

namespace zenith {

// A frame just before the program may take it; tests spoil it.
struct FakeFrame {
  std::uint64_t number = 0;
  std::uint32_t sequence = 0;
  Time stamp;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  std::uint32_t bytes_used = 0;
  bool dropped = false;  // by the driver: its number is used up, nobody sees it
};

struct FakeControl {
  std::uint32_t id = 0;
  std::string name;
  std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::int64_t value = 0;
  std::vector<int> choices;
  std::uint32_t flags = 0;
};

struct FakeDevice {
  V4l2Offer offer;
  std::vector<FakeControl> controls;

  // How it behaves.
  bool present = true;
  bool settable_rate = true;
  std::uint32_t max_buffers = 32;
  std::uint32_t padding = 0;  // bytes after each row
  std::uint32_t first_sequence = 0;
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t set_width = 0;  // what S_FMT makes of any width; 0: what was asked
  Duration latency;             // from the stamp to the moment that poll() sees the frame
  std::function<void(FakeFrame&)> spoil;
  std::map<unsigned long, int> failing;  // request -> errno, until it is removed
  bool frozen = false;                   // no frames, no error
  int stream_error = 0;                  // DQBUF's errno; poll() says POLLERR
  std::uint32_t granted_flags = 0;       // of the last REQBUFS

  // The stream's state.
  struct Buffer {
    std::vector<std::uint8_t> memory;
    FakeFrame frame;
  };
  std::vector<Buffer> buffers;
  std::vector<std::uint32_t> queued;
  std::vector<std::uint32_t> done;
  bool streaming = false;
  std::uint64_t produced = 0;
  Time next_frame;
  std::uint32_t fourcc = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  V4l2Interval interval = {1, 30};
  int open_files = 0;
  int mapped = 0;
};

class FakeV4l2 final : public V4l2Io {
 public:
  static constexpr std::uint8_t kFirstValue = 10;
  static constexpr std::uint8_t kStaleValue = 5;  // of the frame that each stream begins with

  // Stays the caller's to change; lives as long as this.
  FakeDevice& add(const V4l2Offer& offer);

  // Lets time pass, frames come.
  void advance(Duration by);

  std::vector<std::string> list() override;
  int open(const char* path) override;
  void close(int fd) override;
  int control(int fd, unsigned long request, void* argument) override;
  void* map(int fd, std::size_t length, std::int64_t offset) override;
  void unmap(void* start, std::size_t length) override;
  int poll(int fd, Duration timeout) override;
  Time now() override { return now_; }

 private:
  void produce_until(FakeDevice& device, Time until);

  std::vector<std::unique_ptr<FakeDevice>> devices_;
  std::vector<FakeDevice*> files_;  // by file descriptor
  Time now_ = {1'000'000'000'000};
};

// Offers as real devices make them.
V4l2Offer uvc_webcam_offer();     // YUYV and MJPG, fast only when small or compressed
V4l2Offer mono_sensor_offer();    // GREY and Y10, one size, no rates: an OV9281
V4l2Offer vivid_offer();          // GREY and more, several sizes
V4l2Offer idle_loopback_offer();  // v4l2loopback, exclusive_caps=1, before its writer starts
V4l2Offer isp_offer();            // multi-planar NV12M, a range of sizes and rates

}  // namespace zenith
