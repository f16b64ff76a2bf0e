#pragma once
// The fixed memory of a daemon's algorithm: all that is taken for mapping and for the exchange with
// peers before the threads start. Not in it: camera buffers, frames that wait for a recorder, what
// the C library and the program itself take.

#include <string>

#include "platform/base/memory_table.h"
#include "platform/daemon/config.h"

namespace zenith {

// Without a key there is no exchange, and no memory for it.
MemoryTable daemon_memory(const DaemonConfig& config);

// A line for each part and one for the total, in MiB.
std::string memory_text(const MemoryTable& table);

}  // namespace zenith
