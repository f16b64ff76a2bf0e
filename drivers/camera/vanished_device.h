#pragma once
// Whether a camera's device is gone although a library still holds it open.

#include <vector>

namespace zenith {

// Asks a video device for its capabilities: 0, or -errno. ENODEV, of every call, says that the
// kernel has taken the device away.
using QueryVideoDevice = int (*)(int fd);
int query_video_device(int fd);

// The descriptors of this process that are character devices of Video4Linux: video and sub-device
// nodes, whoever opened them.
std::vector<int> open_video_devices();

// Whether one of them exists no longer. For a thread without deadlines.
bool has_vanished(const std::vector<int>& fds, QueryVideoDevice query = query_video_device);

}  // namespace zenith
