#include <utility>

#include "platform/daemon/simulated/recording_source.h"
#include "platform/daemon/simulated/simulated_devices.h"
#include "platform/linux/log.h"

namespace zenith {

Result<Devices> make_replayed_devices(const DaemonConfig& config) {
  auto source = RecordingSource::open(config.replay);
  if (!source) return source.error();
  log_lines(LogLevel::kWarning, "replay", (*source)->warnings());
  const std::string description = "replay of " + config.replay.folder;
  const RobotConfig robot = (*source)->robot();
  const WheelDecoder decoder = (*source)->decoder();
  const WheelCodecConfig odometry = (*source)->odometry();
  auto devices = make_played_devices(std::move(*source), robot, decoder, description);
  devices.odometry = odometry;
  return devices;
}

}  // namespace zenith
