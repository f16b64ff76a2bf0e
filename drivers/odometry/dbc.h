#pragma once
// The part of DBC files that odometry needs: BO_ (messages), SG_ (signals), SIG_VALTYPE_ (floats)
// and SG_MUL_VAL_ (multiplexing). All other statements of the format are read by its grammar and
// passed over; what is none of them is an error with its line.
//
//   BO_ 170 WHEELS: 8 BASE
//    SG_ LEFT : 6|15@0+ (0.01,-67.67) [0|0] "km/h" Vector__XXX
//   SIG_VALTYPE_ 170 LEFT : 1;
//   SG_MUL_VAL_ 170 LEFT PAGE 0-0, 2-5;
//
// Names and texts are bytes in any encoding. For start-up: allocates. Files of other people are
// input: every error is a value.

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
  std::string selector;           // of SG_MUL_VAL_; empty: the message's only "M"
  std::vector<DbcRange> ranges;   // of SG_MUL_VAL_, in place of the number in `multiplexing`
  std::uint32_t written_id = 0;   // as in the file: bit 31 marks a 29-bit identifier
  std::uint32_t frame_bytes = 0;  // of the message
  int line = 0;
  DbcSignal signal;
  DbcConditions conditions;  // filled in by find_signal()
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
// says why: unknown and ambiguous names, signals that do not fit the message or a classic frame,
// floats of a wrong length, a scale of zero, multiplexing whose
// selector is missing or not alone.
Result<DbcEntry> find_signal(const DbcFile& file, std::string_view name);

}  // namespace zenith
