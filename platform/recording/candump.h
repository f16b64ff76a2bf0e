#pragma once
// What `candump` of can-utils writes, one line at a time.
//
// Log format (-l, -L; also other programs'):   (seconds) interface ID#DATA [R|T]
//
//   (1436509052.249713) can0 311#0000002A0000002B      11-bit identifier: three digits
//   (1436509052.249713) can0 0000091B#00112233         29-bit identifier: eight digits
//   123#R, 123#R4   remote frame;   123##1AABB   CAN FD;   20000004#...   error frame
//
// Columns (without -L):   (stamp)  interface  [RX|TX flags]  ID  [length]  bytes  ['ASCII']
//
//    (1436509052.249713)  can0  311   [8]  00 00 00 2A 00 00 00 2B   '...*...+'
//     can0  0000091B   [4]  00 11 22 33
//
// bytes in hexadecimal, binary (-i) or swapped (-S, "2B`00"); "remote request", "ERRORFRAME"; a
// length of two digits and more is CAN FD's. The interface may be missing in both.
//
// Stamps: -ta, -L and -l write seconds since 1970 with ten digits before the point; -tz (since the
// first frame) and -td (since the last one) with three or more; -tA the local date and time.

#include <string>
#include <string_view>

#include "drivers/odometry/can_frame.h"

namespace zenith {

enum class CandumpLine {
  kFrame,   // a classic data frame
  kRemote,  // these are well formed, but carry no data of a base
  kFd,
  kError,
  kDropped,  // candump itself lost frames (-d)
  kEmpty,    // or a further line about an error (-e)
  kMalformed,
};

enum class CandumpStamp {
  kNone,
  kSeconds,     // since an epoch: ten digits and more before the point; or one or two
  kFewSeconds,  // three to nine digits: -tz, -td, or another program's clock
  kLocalDate,   // taken as if it were UTC
};

struct CandumpRecord {
  CandumpLine line = CandumpLine::kMalformed;
  CandumpStamp stamp = CandumpStamp::kNone;
  bool columns = false;        // not the log format
  CanFrame frame;              // kFrame: all of it; otherwise its stamp, where the line has one
  std::string_view interface;  // views into the line; empty: it names none
};

CandumpRecord parse_candump(std::string_view line);

// Without the colours of candump -c.
std::string without_colours(std::string_view line);

// A line of the log format, without the newline.
std::string format_candump(const CanFrame& frame, std::string_view interface);

}  // namespace zenith
