#pragma once

#include "platform/base/time.h"

namespace zenith {

// Waits until `fd` can be read or has an error: poll()'s events, 0 after `timeout` or a signal, or
// -errno. A timeout of zero or less does not wait. For the realtime thread, too.
int wait_readable(int fd, Duration timeout);

}  // namespace zenith
