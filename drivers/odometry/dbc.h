#pragma once
// The part of DBC files that odometry needs: BO_ (messages), SG_ (signals), SIG_VALTYPE_ (floats).
// All other statements are passed over.
//
//   BO_ 170 WHEELS: 8 BASE
//    SG_ LEFT : 6|15@0+ (0.01,-67.67) [0|0] "km/h" Vector__XXX
//   SIG_VALTYPE_ 170 LEFT : 1;
//
// For start-up: allocates. Files of other people are input: every error is a value.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/odometry/dbc_signal.h"
#include "platform/base/result.h"

namespace zenith {

inline constexpr std::size_t kMaxDbcBytes = std::size_t{8} << 20U;

struct DbcEntry {
  std::string message;
  std::string name;
  std::string unit;
  std::string multiplexing;       // "", "M" (the selector itself), "m3", "m3M"
  std::uint32_t written_id = 0;   // as in the file: bit 31 marks a 29-bit identifier
  std::uint32_t frame_bytes = 0;  // of the message
  int line = 0;
  DbcSignal signal;
};

struct DbcFile {
  std::string path;
  std::vector<DbcEntry> signals;  // in the order of the file
};

// `path` names the text in messages. The error lists what is malformed, each with its line.
Result<DbcFile> parse_dbc(std::string_view text, const std::string& path);
// Reads the file; at most kMaxDbcBytes.
Result<DbcFile> load_dbc(const std::string& path);

// `name` is SIGNAL, or MESSAGE.SIGNAL where several messages have one of that name. Refuses, and
// says why: unknown and ambiguous names, multiplexed signals, signals that do not fit the message
// or a classic frame, floats of a wrong length, a scale of zero.
Result<DbcEntry> find_signal(const DbcFile& file, std::string_view name);

}  // namespace zenith
