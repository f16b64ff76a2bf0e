// Any text as a DBC file: each signal that may be used reads and writes every frame within its
// eight bytes.

#include <cmath>
#include <cstdint>
#include <string_view>

#include "drivers/odometry/dbc.h"
#include "drivers/odometry/dbc_signal.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace zenith;  // NOLINT(google-build-using-namespace)
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto file = parse_dbc(text, "base.dbc");
  if (!file) {
    require(file.error().message.starts_with("base.dbc:"));
    return 0;
  }
  require(!file->signals.empty());
  for (const DbcEntry& entry : file->signals) {
    const auto found = find_signal(*file, entry.message + "." + entry.name);
    if (!found) continue;
    const DbcSignal& signal = found->signal;
    require(signal.bit_length >= 1 && signal.bit_length <= 64);
    require(bytes_needed(signal) <= 8);
    CanFrame frame;
    frame.length = 8;
    for (std::size_t i = 0; i < frame.data.size(); ++i) {
      frame.data[i] = i < size ? data[size - 1 - i] : 0;
    }
    const std::uint64_t raw = read_raw(signal, frame);
    write_raw(signal, raw, frame);
    require(read_raw(signal, frame) == raw);
    encode_signal(signal, physical_of(signal, raw), frame);
    require(frame.length <= 8);
  }
  return 0;
}
