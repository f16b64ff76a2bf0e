#include "tests/unit/drivers/camera/fake_v4l2.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "drivers/camera/luma_format.h"

namespace zenith {
namespace {

constexpr int kFirstFd = 100;
constexpr std::int64_t kOffsetStep = 1 << 20;  // offset of buffer i is i * kOffsetStep

template <std::size_t N>
void put_text(__u8 (&field)[N], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), N));  // a full field has no final zero
}

const V4l2FormatOffer* format_of(const FakeDevice& device, std::uint32_t fourcc) {
  for (const V4l2FormatOffer& format : device.offer.formats) {
    if (format.fourcc == fourcc) return &format;
  }
  return nullptr;
}

std::uint32_t stride_of(const FakeDevice& device) {
  const LumaFormat* luma = find_luma_format(device.fourcc);
  const auto bytes = static_cast<std::uint32_t>(luma != nullptr ? luma->bytes_per_pixel() : 1);
  return device.width * bytes + device.padding;
}

std::uint32_t frame_bytes(const FakeDevice& device) {
  return stride_of(device) * device.height;
}

int query_capability(const FakeDevice& device, v4l2_capability& out) {
  out = {};
  put_text(out.driver, device.offer.driver);
  put_text(out.card, device.offer.card);
  put_text(out.bus_info, device.offer.bus);
  std::uint32_t caps = 0;
  if (device.offer.captures) {
    caps |= device.offer.multiplanar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE;
  }
  if (device.offer.has_output) caps |= V4L2_CAP_VIDEO_OUTPUT;
  if (device.offer.streams) caps |= V4L2_CAP_STREAMING;
  out.device_caps = caps;
  // What other nodes of the hardware can do must not be taken for this one's.
  out.capabilities = caps | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  return 0;
}

int enumerate_format(const FakeDevice& device, v4l2_fmtdesc& entry) {
  const std::uint32_t type =
      device.offer.multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (entry.type != type || entry.index >= device.offer.formats.size()) return -EINVAL;
  const V4l2FormatOffer& format = device.offer.formats[entry.index];
  entry.pixelformat = format.fourcc;
  entry.flags = format.compressed ? V4L2_FMT_FLAG_COMPRESSED : 0;
  put_text(entry.description, format.description);
  return 0;
}

int enumerate_size(const FakeDevice& device, v4l2_frmsizeenum& entry) {
  const V4l2FormatOffer* format = format_of(device, entry.pixel_format);
  if (format == nullptr || entry.index >= format->sizes.size()) return -EINVAL;
  const V4l2SizeOffer& size = format->sizes[entry.index];
  if (size.is_range()) {
    entry.type = V4L2_FRMSIZE_TYPE_STEPWISE;
    entry.stepwise = {size.min_width,  size.max_width,  size.step_width,
                      size.min_height, size.max_height, size.step_height};
  } else {
    entry.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    entry.discrete = {size.min_width, size.min_height};
  }
  return 0;
}

v4l2_fract fraction(const V4l2Interval& interval) {
  return {interval.numerator, interval.denominator};
}

int enumerate_interval(const FakeDevice& device, v4l2_frmivalenum& entry) {
  const V4l2FormatOffer* format = format_of(device, entry.pixel_format);
  if (format == nullptr) return -EINVAL;
  for (const V4l2SizeOffer& size : format->sizes) {
    if (!size.holds(static_cast<int>(entry.width), static_cast<int>(entry.height))) continue;
    if (size.rates.is_range() && entry.index == 0) {
      entry.type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
      entry.stepwise = {fraction(size.rates.shortest), fraction(size.rates.longest), {1, 1}};
      return 0;
    }
    if (entry.index >= size.rates.discrete.size()) return -EINVAL;
    entry.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    entry.discrete = fraction(size.rates.discrete[entry.index]);
    return 0;
  }
  return -EINVAL;
}

int set_format(FakeDevice& device, v4l2_format& format) {
  if (device.streaming) return -EBUSY;
  v4l2_pix_format& pix = format.fmt.pix;
  v4l2_pix_format_mplane& planes = format.fmt.pix_mp;
  device.fourcc = device.offer.multiplanar ? planes.pixelformat : pix.pixelformat;
  device.width = device.offer.multiplanar ? planes.width : pix.width;
  device.height = device.offer.multiplanar ? planes.height : pix.height;
  if (device.set_width != 0) device.width = device.set_width;
  if (device.offer.multiplanar) {
    planes.width = device.width;
    planes.field = device.field;
    planes.num_planes = 2;
    planes.plane_fmt[0].bytesperline = stride_of(device);
  } else {
    pix.width = device.width;
    pix.field = device.field;
    pix.bytesperline = stride_of(device);
    pix.sizeimage = frame_bytes(device);
  }
  return 0;
}

int parameters(FakeDevice& device, v4l2_streamparm& parm, bool set) {
  v4l2_captureparm& capture = parm.parm.capture;
  if (set && device.settable_rate) {
    device.interval = {capture.timeperframe.numerator, capture.timeperframe.denominator};
  }
  capture.capability = device.settable_rate ? V4L2_CAP_TIMEPERFRAME : 0;
  capture.timeperframe = fraction(device.interval);
  return 0;
}

int request_buffers(FakeDevice& device, v4l2_requestbuffers& request) {
  if (device.streaming) return -EBUSY;
  if (device.mapped > 0) return -EBUSY;
  device.queued.clear();
  device.done.clear();
  device.granted_flags = request.flags;
  request.count = std::min(request.count, device.max_buffers);
  request.capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP | V4L2_BUF_CAP_SUPPORTS_MMAP_CACHE_HINTS;
  device.buffers.assign(request.count, {});
  for (auto& buffer : device.buffers) buffer.memory.resize(frame_bytes(device));
  device.queued.reserve(device.buffers.size());
  device.done.reserve(device.buffers.size());
  return 0;
}

bool is_multiplanar(const v4l2_buffer& buffer) {
  return buffer.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

int query_buffer(const FakeDevice& device, v4l2_buffer& buffer) {
  if (buffer.index >= device.buffers.size()) return -EINVAL;
  const auto offset = static_cast<std::uint32_t>(buffer.index * kOffsetStep);
  if (is_multiplanar(buffer)) {
    buffer.m.planes[0].length = frame_bytes(device);
    buffer.m.planes[0].m.mem_offset = offset;
  } else {
    buffer.length = frame_bytes(device);
    buffer.m.offset = offset;
  }
  return 0;
}

int queue_buffer(FakeDevice& device, const v4l2_buffer& buffer) {
  const auto& queued = device.queued;
  if (buffer.index >= device.buffers.size()) return -EINVAL;
  if (std::find(queued.begin(), queued.end(), buffer.index) != queued.end()) return -EINVAL;
  device.queued.push_back(buffer.index);
  return 0;
}

int dequeue_buffer(FakeDevice& device, v4l2_buffer& buffer) {
  if (device.stream_error != 0) return -device.stream_error;
  if (!device.streaming) return -EINVAL;
  if (device.done.empty()) return -EAGAIN;
  buffer.index = device.done.front();
  device.done.erase(device.done.begin());
  const FakeFrame& frame = device.buffers[buffer.index].frame;
  buffer.sequence = frame.sequence;
  buffer.flags = frame.flags;
  buffer.timestamp.tv_sec = frame.stamp.ns / 1'000'000'000;
  buffer.timestamp.tv_usec = frame.stamp.ns % 1'000'000'000 / 1000;
  if (is_multiplanar(buffer)) {
    buffer.m.planes[0].bytesused = frame.bytes_used;
  } else {
    buffer.bytesused = frame.bytes_used;
  }
  return 0;
}

void fill(const FakeDevice& device, std::vector<std::uint8_t>& memory, std::uint64_t number) {
  const auto value = static_cast<std::uint8_t>(FakeV4l2::kFirstValue + number);
  std::memset(memory.data(), 77, memory.size());  // chroma and padding
  const LumaFormat* luma = find_luma_format(device.fourcc);
  const std::size_t step = luma->bytes_per_pixel();
  const std::size_t first = luma->layout == LumaLayout::kOddBytes ? 1 : 0;
  for (std::uint32_t v = 0; v < device.height; ++v) {
    for (std::uint32_t u = 0; u < device.width; ++u) {
      memory[v * stride_of(device) + u * step + first] = value;
    }
  }
}

FakeControl* find_control(FakeDevice& device, std::uint32_t id) {
  for (FakeControl& control : device.controls) {
    if (control.id == id) return &control;
  }
  return nullptr;
}

FakeControl* next_control(FakeDevice& device, std::uint32_t after) {
  FakeControl* next = nullptr;
  for (FakeControl& control : device.controls) {
    if (control.id > after && (next == nullptr || control.id < next->id)) next = &control;
  }
  return next;
}

int query_control(FakeDevice& device, v4l2_queryctrl& entry) {
  const bool next = (entry.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const FakeControl* control = next ? next_control(device, entry.id & ~V4L2_CTRL_FLAG_NEXT_CTRL)
                                    : find_control(device, entry.id);
  if (control == nullptr) return -EINVAL;
  entry.id = control->id;
  entry.type = control->type;
  entry.minimum = static_cast<int>(control->min);
  entry.maximum = static_cast<int>(control->max);
  entry.step = 1;
  entry.flags = control->flags;
  put_text(entry.name, control->name);
  return 0;
}

int query_menu(FakeDevice& device, v4l2_querymenu& item) {
  const FakeControl* control = find_control(device, item.id);
  if (control == nullptr) return -EINVAL;
  const auto& choices = control->choices;
  const bool has =
      std::find(choices.begin(), choices.end(), static_cast<int>(item.index)) != choices.end();
  if (!has) return -EINVAL;
  std::memcpy(item.name, "choice", sizeof("choice"));  // packed: put_text cannot bind it
  return 0;
}

int access_control(FakeDevice& device, v4l2_control& argument, bool set) {
  FakeControl* control = find_control(device, argument.id);
  if (control == nullptr) return -EINVAL;
  if (!set) {
    argument.value = static_cast<int>(control->value);
    return 0;
  }
  if (argument.value < control->min || argument.value > control->max) return -ERANGE;
  control->value = argument.value;
  return 0;
}

int read_extended(FakeDevice& device, v4l2_ext_controls& argument) {
  const FakeControl* control = find_control(device, argument.controls[0].id);
  if (control == nullptr) return -EINVAL;
  argument.controls[0].value64 = control->value;
  return 0;
}

template <typename T>
T& as(void* argument) {
  return *static_cast<T*>(argument);
}

// As v4l2loopback does: the last picture of an earlier stream, with a stamp of now.
void give_stale_frame(FakeDevice& device, Time now) {
  if (device.frozen || device.queued.empty()) return;
  const std::uint32_t index = device.queued.front();
  device.queued.erase(device.queued.begin());
  FakeFrame stale;
  stale.sequence = device.first_sequence - 40;
  stale.stamp = now;
  stale.bytes_used = frame_bytes(device);
  std::ranges::fill(device.buffers[index].memory, FakeV4l2::kStaleValue);
  device.buffers[index].frame = stale;
  device.done.push_back(index);
}

int set_streaming(FakeDevice& device, bool on, Time now) {
  device.streaming = on;
  device.produced = 0;
  device.next_frame = now + Duration::from_seconds(1.0 / device.interval.rate_hz());
  device.done.clear();
  if (on) {
    device.stream_error = 0;
    give_stale_frame(device, now);
  } else {
    device.queued.clear();
  }
  return 0;
}

}  // namespace

FakeDevice& FakeV4l2::add(const V4l2Offer& offer) {
  devices_.push_back(std::make_unique<FakeDevice>());
  devices_.back()->offer = offer;
  return *devices_.back();
}

void FakeV4l2::advance(Duration by) {
  now_ = now_ + by;
  for (const auto& device : devices_) produce_until(*device, now_);
}

void FakeV4l2::produce_until(FakeDevice& device, Time until) {
  if (!device.streaming || !device.present || device.frozen || device.stream_error != 0) {
    device.next_frame = std::max(device.next_frame, until);
    return;
  }
  const Duration period = Duration::from_seconds(1.0 / device.interval.rate_hz());
  for (; device.next_frame <= until; device.next_frame = device.next_frame + period) {
    FakeFrame frame;
    frame.number = device.produced++;
    frame.sequence = device.first_sequence + static_cast<std::uint32_t>(frame.number);
    frame.stamp = device.next_frame - device.latency;
    frame.bytes_used = frame_bytes(device);
    if (device.spoil) device.spoil(frame);
    if (frame.dropped || device.queued.empty()) continue;
    const std::uint32_t index = device.queued.front();
    device.queued.erase(device.queued.begin());
    fill(device, device.buffers[index].memory, frame.number);
    device.buffers[index].frame = frame;
    device.done.push_back(index);
  }
}

std::vector<std::string> FakeV4l2::list() {
  std::vector<std::string> paths;
  for (const auto& device : devices_) {
    if (device->present) paths.push_back(device->offer.path);
  }
  return paths;
}

int FakeV4l2::open(const char* path) {
  for (const auto& device : devices_) {
    if (device->offer.path != path || !device->present) continue;
    files_.push_back(device.get());
    ++device->open_files;
    return kFirstFd + static_cast<int>(files_.size()) - 1;
  }
  return -ENOENT;
}

void FakeV4l2::close(int fd) {
  FakeDevice*& device = files_[static_cast<std::size_t>(fd - kFirstFd)];
  if (--device->open_files == 0) set_streaming(*device, false, now_);
  device = nullptr;
}

int FakeV4l2::control(int fd, unsigned long request, void* argument) {
  FakeDevice& device = *files_[static_cast<std::size_t>(fd - kFirstFd)];
  if (!device.present) return -ENODEV;
  const auto failing = device.failing.find(request);
  if (failing != device.failing.end()) return -failing->second;
  switch (request) {
    case VIDIOC_QUERYCAP:
      return query_capability(device, as<v4l2_capability>(argument));
    case VIDIOC_ENUM_FMT:
      return enumerate_format(device, as<v4l2_fmtdesc>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return enumerate_size(device, as<v4l2_frmsizeenum>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return enumerate_interval(device, as<v4l2_frmivalenum>(argument));
    case VIDIOC_S_FMT:
      return set_format(device, as<v4l2_format>(argument));
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return parameters(device, as<v4l2_streamparm>(argument), request == VIDIOC_S_PARM);
    case VIDIOC_REQBUFS:
      return request_buffers(device, as<v4l2_requestbuffers>(argument));
    case VIDIOC_QUERYBUF:
      return query_buffer(device, as<v4l2_buffer>(argument));
    case VIDIOC_QBUF:
      return queue_buffer(device, as<v4l2_buffer>(argument));
    case VIDIOC_DQBUF:
      return dequeue_buffer(device, as<v4l2_buffer>(argument));
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return set_streaming(device, request == VIDIOC_STREAMON, now_);
    case VIDIOC_QUERYCTRL:
      return query_control(device, as<v4l2_queryctrl>(argument));
    case VIDIOC_QUERYMENU:
      return query_menu(device, as<v4l2_querymenu>(argument));
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return access_control(device, as<v4l2_control>(argument), request == VIDIOC_S_CTRL);
    case VIDIOC_G_EXT_CTRLS:
      return read_extended(device, as<v4l2_ext_controls>(argument));
    default:
      return -ENOTTY;
  }
}

void* FakeV4l2::map(int fd, std::size_t length, std::int64_t offset) {
  FakeDevice& device = *files_[static_cast<std::size_t>(fd - kFirstFd)];
  auto& memory = device.buffers[static_cast<std::size_t>(offset / kOffsetStep)].memory;
  if (length > memory.size()) return nullptr;
  ++device.mapped;
  return memory.data();
}

void FakeV4l2::unmap(void* start, std::size_t length) {
  for (const auto& device : devices_) {
    for (const auto& buffer : device->buffers) {
      if (buffer.memory.data() == start && buffer.memory.size() >= length) --device->mapped;
    }
  }
}

int FakeV4l2::poll(int fd, Duration timeout) {
  const FakeDevice& device = *files_[static_cast<std::size_t>(fd - kFirstFd)];
  const Time deadline = now_ + std::max(timeout, Duration{0});
  while (device.present && device.stream_error == 0 && device.done.empty() && now_ < deadline) {
    const bool comes = device.streaming && !device.frozen && device.next_frame > now_;
    advance((comes ? std::min(device.next_frame, deadline) : deadline) - now_);
  }
  if (!device.present) return POLLERR | POLLHUP;
  if (device.stream_error != 0) return POLLERR;
  return device.done.empty() ? 0 : POLLIN;
}

}  // namespace zenith
