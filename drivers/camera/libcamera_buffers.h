#pragma once
// The first plane of libcamera's buffers, mapped for reading.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <libcamera/framebuffer.h>

#include "platform/base/result.h"

namespace zenith {

class LibcameraBuffers {
 public:
  LibcameraBuffers() = default;
  LibcameraBuffers(const LibcameraBuffers&) = delete;
  LibcameraBuffers& operator=(const LibcameraBuffers&) = delete;
  ~LibcameraBuffers() { unmap(); }

  // `name` begins the error. The buffer must outlive its mapping.
  Status map(const std::string& name, const libcamera::FrameBuffer& buffer,
             std::size_t needed_bytes);
  void unmap();

  // For the realtime thread: around the reading of a buffer, so that what the hardware wrote is
  // seen. Buffers that need none of this refuse it, which does no harm.
  void begin_read(std::size_t index) const;
  void end_read(std::size_t index) const;
  const std::uint8_t* data(std::size_t index) const { return buffers_[index].data; }
  std::size_t size() const { return buffers_.size(); }

 private:
  struct Buffer {
    int fd = -1;  // libcamera's
    void* start = nullptr;
    std::size_t length = 0;
    const std::uint8_t* data = nullptr;
  };
  std::vector<Buffer> buffers_;
};

}  // namespace zenith
