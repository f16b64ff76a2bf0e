#include "drivers/camera/v4l2_stream.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>

#include "platform/linux/errno_text.h"

namespace zenith {
namespace {

using Planes = std::array<v4l2_plane, VIDEO_MAX_PLANES>;

constexpr std::uint32_t kMinBuffers = 2;  // one that the caller looks at, one that fills

// A stamp beyond the range of Time comes back as its end: the judge of stamps refuses that.
Time time_of(std::int64_t seconds, std::int64_t microseconds) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  if (seconds < 0 || seconds >= kMax / kSecond_ns - 1) return {kMax};
  return {seconds * kSecond_ns + std::clamp<std::int64_t>(microseconds, 0, 999'999) * 1000};
}

v4l2_buffer buffer_of(std::uint32_t type, bool multiplanar, Planes& planes) {
  v4l2_buffer buffer = {};
  buffer.type = type;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (multiplanar) {
    buffer.m.planes = planes.data();
    buffer.length = static_cast<std::uint32_t>(planes.size());
  }
  return buffer;
}

// Buffers of many ARM drivers are mapped uncached, which makes reading them slow. Where the kernel
// can keep cached ones coherent by itself, it is asked to.
int request_buffers(const V4l2Device& device, std::uint32_t type, v4l2_requestbuffers& request) {
  v4l2_requestbuffers question = {};
  question.type = type;
  question.memory = V4L2_MEMORY_MMAP;
  const bool answered = device.control(VIDIOC_REQBUFS, &question) >= 0;
  request.type = type;
  request.memory = V4L2_MEMORY_MMAP;
#if defined(V4L2_BUF_CAP_SUPPORTS_MMAP_CACHE_HINTS) && defined(V4L2_MEMORY_FLAG_NON_COHERENT)
  if (answered && (question.capabilities & V4L2_BUF_CAP_SUPPORTS_MMAP_CACHE_HINTS) != 0) {
    request.flags = V4L2_MEMORY_FLAG_NON_COHERENT;
  }
#else
  static_cast<void>(answered);
#endif
  return device.control(VIDIOC_REQBUFS, &request);
}

std::string start_advice(int error) {
  switch (error) {
    case ENOSPC:
      return "the USB bus has no bandwidth left: lower the rate or size, or use another port";
    case EPIPE:
    case ENOLINK:
      return "the links from the sensor to this node are not set up for this size and format "
             "('media-ctl -p' shows them)";
    case EBUSY:
      return "another program streams from it";
    default:
      return "plug it in again, or restart the writer of a loop-back device";
  }
}

}  // namespace

Status V4l2Stream::start(const V4l2Device& device, const std::string& name, bool multiplanar,
                         int buffers, std::size_t needed_bytes) {
  stop();
  device_ = &device;
  multiplanar_ = multiplanar;
  type_ = multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  Status status = start_buffers(name, buffers, needed_bytes);
  if (!status) stop();
  return status;
}

Status V4l2Stream::start_buffers(const std::string& name, int buffers, std::size_t needed_bytes) {
  v4l2_requestbuffers request = {};
  request.count = static_cast<std::uint32_t>(buffers);
  const int requested = request_buffers(*device_, type_, request);
  if (requested < 0) {
    return Error{name + ": cannot get buffers: " + errno_text(-requested) + "; " +
                 start_advice(-requested)};
  }
  if (request.count < kMinBuffers) {
    return Error{name + ": the driver gave " + std::to_string(request.count) + " of " +
                 std::to_string(buffers) + " buffers, at least 2 are needed; free memory, or ask " +
                 "for a smaller size"};
  }
  for (std::uint32_t i = 0; i < request.count; ++i) {
    Status mapped = map_buffer(name, i, needed_bytes);
    if (!mapped) return mapped;
  }
  for (std::uint32_t i = 0; i < request.count; ++i) {
    const int queued = give_back(i);
    if (queued < 0) return Error{name + ": cannot queue a buffer: " + errno_text(-queued)};
  }
  int type = static_cast<int>(type_);
  const int started = device_->control(VIDIOC_STREAMON, &type);
  if (started < 0) {
    return Error{name + ": the stream does not start: " + errno_text(-started) + "; " +
                 start_advice(-started)};
  }
  return {};
}

Status V4l2Stream::map_buffer(const std::string& name, std::uint32_t index,
                              std::size_t needed_bytes) {
  Planes planes = {};
  v4l2_buffer buffer = buffer_of(type_, multiplanar_, planes);
  buffer.index = index;
  const int queried = device_->control(VIDIOC_QUERYBUF, &buffer);
  if (queried < 0) return Error{name + ": cannot query a buffer: " + errno_text(-queried)};
  const std::size_t length = multiplanar_ ? planes[0].length : buffer.length;
  const std::int64_t offset = multiplanar_ ? planes[0].m.mem_offset : buffer.m.offset;
  if (length < needed_bytes) {
    return Error{name + ": a frame needs " + std::to_string(needed_bytes) +
                 " bytes, the driver's buffers have " + std::to_string(length) +
                 "; ask for another format"};
  }
  void* start = device_->io().map(device_->fd(), length, offset);
  if (start == nullptr) {
    return Error{name + ": cannot map a buffer of " + std::to_string(length) +
                 " bytes; is the limit of locked memory (LimitMEMLOCK) too small?"};
  }
  buffers_.push_back({static_cast<std::uint8_t*>(start), length});
  return {};
}

void V4l2Stream::stop() {
  if (device_ == nullptr) return;
  int type = static_cast<int>(type_);
  device_->control(VIDIOC_STREAMOFF, &type);
  for (const Buffer& buffer : buffers_) device_->io().unmap(buffer.start, buffer.length);
  buffers_.clear();
  v4l2_requestbuffers request = {};
  request.type = type_;
  request.memory = V4L2_MEMORY_MMAP;
  device_->control(VIDIOC_REQBUFS, &request);
  device_ = nullptr;
}

int V4l2Stream::take(V4l2Taken& out) {
  Planes planes = {};
  v4l2_buffer buffer = buffer_of(type_, multiplanar_, planes);
  const int result = device_->control(VIDIOC_DQBUF, &buffer);
  if (result < 0) return result;
  if (buffer.index >= buffers_.size()) return -EPROTO;
  out.index = buffer.index;
  out.sequence = buffer.sequence;
  out.stamp = time_of(buffer.timestamp.tv_sec, buffer.timestamp.tv_usec);
  out.stamp_monotonic =
      (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  out.error = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  const std::size_t length = buffers_[buffer.index].length;
  const std::size_t used = multiplanar_ ? planes[0].bytesused : buffer.bytesused;
  out.offset = multiplanar_ ? std::min<std::size_t>(planes[0].data_offset, length) : 0;
  const std::size_t end = std::min(used, length);
  out.bytes = end > out.offset ? end - out.offset : 0;
  return 0;
}

int V4l2Stream::give_back(std::uint32_t index) {
  Planes planes = {};
  v4l2_buffer buffer = buffer_of(type_, multiplanar_, planes);
  buffer.index = index;
  return device_->control(VIDIOC_QBUF, &buffer);
}

}  // namespace zenith
