#pragma once
// From a base's CAN frames to the total travel of its wheels, for every codec.
//
// Readings of both wheels in one frame give a sample at the frame's stamp; an impossible step of
// one wheel is then a restart of both. Where each wheel has frames of its own (ODrive, VESC), a
// sample is given when both have news since the last one. Its stamp is the older of their newest
// stamps: the travel of the other wheel is interpolated there, between its last two readings. So a
// sample may be older than the frame that completed it, by at most the time between two frames of a
// wheel. A wheel that falls silent silences the samples: its partner's frames are counted as
// `unpaired`.
//
// Plain data, no heap and no lock when decoding; one caller at a time.

#include <cstdint>
#include <optional>
#include <variant>

#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/can_frame.h"
#include "drivers/odometry/canopen.h"
#include "drivers/odometry/dbc_codec.h"
#include "drivers/odometry/odrive.h"
#include "drivers/odometry/vesc.h"
#include "drivers/odometry/wheel_accumulator.h"
#include "drivers/odometry/wheel_codec.h"
#include "drivers/odometry/wheel_watch.h"
#include "slam/wheels.h"

namespace zenith {

using WheelCodec =
    std::variant<agilex_v2::Codec, odrive::Codec, vesc::Codec, canopen::Codec, dbc::Codec>;

struct WheelDecoderCounters {
  std::uint64_t samples = 0;
  std::uint64_t resets = 0;          // implausible steps: the base or its counters restarted
  std::uint64_t late = 0;            // stamp not newer than the wheel's last frame: refused
  std::uint64_t short_frames = 0;    // known identifier, too few bytes: refused
  std::uint64_t invalid = 0;         // not a number, or an impossible velocity: refused
  std::uint64_t unknown_ids = 0;     // not a frame of this base: ignored
  std::uint64_t without_travel = 0;  // of this base, but nothing about travel: ignored
  std::uint64_t velocity_gaps = 0;   // silences of velocities that were bridged only in part
  std::uint64_t unpaired = 0;        // a wheel's frame that came before the other wheel's
  std::uint64_t error_reports = 0;   // frames in which a drive reported an error of its own
};

// The last error codes that the drives reported, 0 when none (ODrive: axis error).
struct WheelErrors {
  std::uint32_t left = 0;
  std::uint32_t right = 0;
};

class WheelDecoder {
 public:
  // AgileX v2, which needs no parameters.
  explicit WheelDecoder(const WheelLimits& limits = {});
  // make_wheel_decoder() of wheel_codec_config.h checks before it calls this.
  WheelDecoder(const WheelCodec& codec, const WheelScales& scales, const WheelLimits& limits);

  // Stamps of samples are those of the frames less this; 0 without.
  void set_latency(Duration latency) { latency_ = latency; }

  // At most one sample for a frame; travel is zero in each wheel's first reading. Stamps of samples
  // rise strictly.
  std::optional<WheelSample> decode(const CanFrame& frame);
  // The same for readings that came by another way than CAN.
  std::optional<WheelSample> take(Time stamp, const WheelNews& news);

  // The identifiers that decode() reads, for the kernel's filter.
  CanIds ids() const;
  const WheelDecoderCounters& counters() const { return counters_; }
  const WheelErrors& errors() const { return errors_; }
  // Whether what is read can be wheels.
  WheelFault fault() const { return watch_.fault(); }

 private:
  void note_errors(const WheelNews& news);
  void watch(Time stamp, const WheelReading& reading, WheelStep step,
             const WheelAccumulator& wheel);
  bool accept(Time stamp, const WheelNews& news);
  void take_wheel(Time stamp, const WheelReading& reading, WheelStep step, WheelAccumulator& wheel,
                  bool& fresh);

  WheelCodec codec_;
  Duration latency_;
  WheelAccumulator left_;
  WheelAccumulator right_;
  bool fresh_left_ = false;  // has news since the last sample
  bool fresh_right_ = false;
  WheelDecoderCounters counters_;
  WheelWatch watch_;
  WheelErrors errors_;
};

}  // namespace zenith
