#include "drivers/camera/libcamera_buffers.h"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <cerrno>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

void synchronise(int fd, std::uint64_t flags) {
  dma_buf_sync sync = {};
  sync.flags = flags | DMA_BUF_SYNC_READ;
  while (::ioctl(fd, DMA_BUF_IOCTL_SYNC, &sync) < 0 && errno == EINTR) {
  }
}

}  // namespace

Status LibcameraBuffers::map(const std::string& name, const libcamera::FrameBuffer& buffer,
                             std::size_t needed_bytes) {
  const libcamera::FrameBuffer::Plane& plane = buffer.planes().front();
  const std::size_t offset =
      plane.offset == libcamera::FrameBuffer::Plane::kInvalidOffset ? 0 : plane.offset;
  if (plane.length < needed_bytes) {
    return Error{name + ": a frame needs " + std::to_string(needed_bytes) +
                 " bytes, the buffers have " + std::to_string(plane.length) +
                 "; ask for another format"};
  }
  // From the beginning: an offset need not be one of a page.
  const std::size_t length = offset + plane.length;
  void* start = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
  if (start == MAP_FAILED) {
    return Error{name + ": cannot map a buffer of " + std::to_string(length) + " bytes: " +
                 errno_text(errno) + "; is the limit of locked memory (LimitMEMLOCK) too small?"};
  }
  buffers_.push_back({plane.fd.get(), start, length, static_cast<std::uint8_t*>(start) + offset});
  return {};
}

void LibcameraBuffers::unmap() {
  for (const Buffer& buffer : buffers_) ::munmap(buffer.start, buffer.length);
  buffers_.clear();
}

void LibcameraBuffers::begin_read(std::size_t index) const {
  synchronise(buffers_[index].fd, DMA_BUF_SYNC_START);
}

void LibcameraBuffers::end_read(std::size_t index) const {
  synchronise(buffers_[index].fd, DMA_BUF_SYNC_END);
}

}  // namespace zenith
