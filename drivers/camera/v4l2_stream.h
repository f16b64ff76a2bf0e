#pragma once
// The buffers that circulate between driver and program: mapped at start, queued, taken, given
// back.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/camera/v4l2_device.h"
#include "platform/base/result.h"
#include "platform/base/time.h"

namespace zenith {

struct V4l2Taken {
  std::uint32_t index = 0;
  std::uint32_t sequence = 0;
  Time stamp;                    // as the driver wrote it
  bool stamp_monotonic = false;  // the driver says that it is of CLOCK_MONOTONIC
  bool error = false;            // the driver says that the contents are damaged
  std::size_t offset = 0;        // of the picture within the buffer
  std::size_t bytes = 0;         // from there on
};

// The device given to start() must stay open until stop(). take() and give_back() are for the
// realtime thread, all else for one without deadlines.
class V4l2Stream {
 public:
  V4l2Stream() = default;
  V4l2Stream(const V4l2Stream&) = delete;
  V4l2Stream& operator=(const V4l2Stream&) = delete;
  ~V4l2Stream() { stop(); }

  // Every buffer holds at least `needed_bytes`. `name` begins the error messages. On an error all
  // that was begun is undone.
  Status start(const V4l2Device& device, const std::string& name, bool multiplanar, int buffers,
               std::size_t needed_bytes);
  void stop();  // also when the device is gone, or nothing was started

  // The oldest finished buffer: 0, -EAGAIN when there is none, or another -errno.
  int take(V4l2Taken& out);
  int give_back(std::uint32_t index);

  std::size_t buffers() const { return buffers_.size(); }
  const std::uint8_t* data(std::uint32_t index) const { return buffers_[index].start; }

 private:
  struct Buffer {
    std::uint8_t* start = nullptr;
    std::size_t length = 0;
  };

  Status start_buffers(const std::string& name, int buffers, std::size_t needed_bytes);
  Status map_buffer(const std::string& name, std::uint32_t index, std::size_t needed_bytes);

  const V4l2Device* device_ = nullptr;
  std::uint32_t type_ = 0;
  bool multiplanar_ = false;
  std::vector<Buffer> buffers_;
};

}  // namespace zenith
