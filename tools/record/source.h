#pragma once
// Where a recording comes from: the running daemon's tap, or the devices themselves.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/daemon/devices.h"
#include "platform/daemon/tap/wire.h"
#include "slam/image/image.h"

namespace zenith::tools {

// What a source hands on. The image is valid during the call.
class RecordSink {
 public:
  virtual ~RecordSink() = default;
  virtual void frame(const tap::FrameHead& head, ImageView image) = 0;
  virtual void can(std::span<const CanFrame> frames) = 0;
  virtual void pose(const tap::TappedPose& pose) = 0;
};

class RecordSource {
 public:
  virtual ~RecordSource() = default;

  virtual const tap::Hello& robot() const = 0;
  // Hands on what comes within `wait`. False when nothing more will come: the daemon has ended.
  virtual Result<bool> take(Duration wait, RecordSink& sink) = 0;
  // Nothing more is wanted; take() goes on until it says false, and hands on what is under way.
  virtual void finish() = 0;
  // What the source itself could not hand on; complete when take() has said false.
  virtual tap::End end() const = 0;
  // Where it comes from, for a person.
  virtual std::string description() const = 0;
};

// Of the daemon that listens at the first of `paths` where one does.
Result<std::unique_ptr<RecordSource>> open_tap_source(const std::vector<std::string>& paths);

// Opens the devices. `devices` were just made.
Result<std::unique_ptr<RecordSource>> open_device_source(const DaemonConfig& config,
                                                         Devices devices);

}  // namespace zenith::tools
