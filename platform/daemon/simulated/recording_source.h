#pragma once
// A recording, moment by moment, for a player (device_player.h).
//
// Stamps are those of the recording, drawn together or apart by the speed, and go on where the
// recording begins anew. A frame whose file is missing or damaged is passed over and counted; the
// first one is logged, and how many there were at the end.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/odometry/wheel_codec_config.h"
#include "platform/base/result.h"
#include "platform/daemon/config.h"
#include "platform/daemon/simulated/device_player.h"
#include "platform/recording/frame_list.h"
#include "platform/recording/robot_file.h"

namespace zenith {

class RecordingSource final : public MomentSource {
 public:
  // Reads and checks everything but the frames. `warnings()` are what was odd.
  static Result<std::unique_ptr<RecordingSource>> open(const ReplayConfig& config);

  const std::string& name() const { return name_; }
  const RobotConfig& robot() const { return robot_; }
  const WheelDecoder& decoder() const { return decoder_; }
  const WheelCodecConfig& odometry() const { return odometry_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  bool next(Moment& moment) override;
  Duration frame_period() const override;
  std::vector<CanFrame> standing() const override;
  void ended() override;

 private:
  RecordingSource() = default;

  Status load();
  Status load_wheels(const RobotFile& robot);
  void begin_anew();
  Time played(Time recorded) const;
  void take_can(Time until, std::vector<CanFrame>& out);
  void take_frame(const ListedFrame& listed, Moment& moment);

  ReplayConfig config_;
  std::string name_;
  RobotConfig robot_;
  WheelDecoder decoder_;
  WheelCodecConfig odometry_;
  WheelQuantity quantity_ = WheelQuantity::kPosition;
  std::vector<std::string> warnings_;
  std::vector<ListedFrame> frames_;
  std::vector<CanFrame> can_;  // stamps do not go back

  std::size_t next_frame_ = 0;
  std::size_t next_can_ = 0;
  Time first_;  // of the recording
  Time base_;   // where it is played from
  Time last_;   // the latest moment that was played
  std::size_t bad_ = 0;
};

}  // namespace zenith
