// zenith calibrate drive: mount and wheels, from a recorded drive.

#include <cstdio>
#include <filesystem>
#include <memory>

#include "platform/recording/layout.h"
#include "platform/recording/recording.h"
#include "tools/atomic_output.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/drive_picture.h"
#include "tools/calibrate/drive_tracks.h"
#include "tools/calibrate/result_files.h"
#include "tools/commands.h"
#include "tools/progress.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHelp =
    R"(Finds what a ruler does not: how the camera is turned and leans, where it sits beside the
point between the wheels, the distance of the wheels' tracks, how the wheels differ, how late the base's
frames are. The lens must be calibrated first; the other numbers may be wrong, the yaw by any angle.
Mistakes of the set-up are named, with the lines of the configuration that mend them: a mirrored
picture, wheels that are exchanged or count backward, a camera turned by a quarter or a half, stamps
that are apart by up to 1.5 s.

One camera does not see how long a metre is. --distance (from where the robot stood at the beginning
of the recording to where it stood at its end, by a tape) or --ceiling (its height above the floor)
says it; with both the height of the camera is found, too.

OUT holds report.txt and drive.png. --write takes over what the drive showed.

Examples:
  zenith calibrate drive --guide
  zenith record rec/drive --config zenith.toml        then drive, and Ctrl-C
  zenith calibrate drive rec/drive --out drive --distance 3.21 --write zenith.toml

docs/calibration.md explains more.)";

constexpr const char* kGuide =
    R"(How to drive, for two minutes, under a ceiling with lamps or other things to see:
  1. Stand still; mark the point between the wheels on the floor. Begin to record.
  2. Drive 3 to 5 m straight, slowly (half a metre a second).
  3. Turn on the spot once round to the left, stop, once round to the right, stop.
  4. Drive back, and do 2 and 3 again: three times in all.
  5. Drive a figure of eight, both circles about 2 m wide.
  6. Ten times: turn a quarter to the left and at once back, briskly.
  7. Stop a few metres from the first mark; mark this point, too. End the recording.
  8. Measure between the marks with a tape: that is --distance.
On the spot, not on carpet that the wheels grip and twist; no faster than the wheels hold.
)";

struct DriveCommand {
  std::string recording;
  std::string out;
  std::string write_to;
  double distance_m = 0.0;
  double ceiling_m = 0.0;
  bool guide = false;
  bool force = false;
};

Result<DriveData> read_drive(const fs::path& folder, std::vector<std::string>& warnings) {
  auto recording = Recording::open(folder, {});
  if (!recording) return recording.error();
  Progress progress("following the ceiling");
  auto data = track_drive(**recording, [&](double fraction) { progress.update(fraction); });
  warnings = (*recording)->warnings();
  return data;
}

// What was found, on top of what the recording's own robot.toml has done to its wheels and stamps.
RobotResult result_of(const DriveCommand& command, const DriveCalibration& c) {
  RobotResult result = {c.robot, c.latency_s, {}};
  const auto known = read_robot_file(layout::robot(command.recording));
  if (!known) return result;
  const WheelCodecConfig& odometry = known->odometry;
  result.latency_s += odometry.latency_s;
  const WheelOrder before = {odometry.swap_wheels, odometry.invert_left, odometry.invert_right};
  const WheelOrder now = c.setup.change.wheels.after(before);
  if (now != before) result.wheels = now;
  return result;
}

// The lines to change, when the set-up itself is wrong.
std::string lines_to_change(const DriveCalibration& c, const RobotResult& result) {
  if (c.setup.causes.empty() || c.judgement.worth == Worth::kAgain) return {};
  std::string text = "lines of zenith.toml that mend it, all of what was found among them:\n\n";
  if (c.setup.change.picture != Mirrored::kNot) {
    const char* flip =
        c.setup.change.picture == Mirrored::kColumns ? "horizontal_flip" : "vertical_flip";
    text += std::string(
                "# First switch off the flip of the camera or its driver, for no line does:\n") +
            "#   v4l2-ctl -d DEVICE --set-ctrl " + flip +
            "=0\n# These are the numbers of the picture the right way round.\n";
  }
  return text + edited_toml("", robot_values(result));
}

int take_over(const DriveCommand& command, const DriveCalibration& c, const RobotResult& result) {
  if (c.judgement.worth == Worth::kAgain) {
    if (command.write_to.empty()) return 1;
    return fail({command.write_to + ": left as it was: the drive is not good enough"});
  }
  if (command.write_to.empty()) return 0;
  const Status written = write_robot(command.write_to, result);
  if (!written) return fail(written.error());
  std::printf("%s: mount and wheels were taken over\n", command.write_to.c_str());
  return 0;
}

int run_drive(const DriveCommand& command) {
  if (command.guide) {
    std::printf("%s", kGuide);
    return 0;
  }
  if (command.recording.empty() || command.out.empty()) {
    return fail({"calibrate drive needs a recording and --out DIR; --guide says how to drive"}) + 1;
  }
  auto output = AtomicFolder::create(command.out, command.force, "report.txt");
  if (!output) return fail(output.error());
  std::vector<std::string> warnings;
  const auto data = read_drive(command.recording, warnings);
  if (!data) return fail(data.error());
  warn(warnings);
  DriveReferences references;
  if (command.distance_m > 0.0) references.distance_m = command.distance_m;
  if (command.ceiling_m > 0.0) references.ceiling_m = command.ceiling_m;
  const DriveCalibration c = calibrate_drive(*data, references);
  const RobotResult robot = result_of(command, c);
  const std::string report = drive_report(c) + lines_to_change(c, robot);
  Status done = write_file(output->path() / "report.txt", report);
  if (done) done = draw_drive(*data, c, output->path() / "drive.png");
  if (done) done = output->commit();
  if (!done) return fail(done.error());
  std::printf("%s%s\n", report.c_str(), command.out.c_str());
  return take_over(command, c, robot);
}

}  // namespace

void add_calibrate_drive(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<DriveCommand>();
  CLI::App* drive = calibrate.add_subcommand("drive", "Calibrate mount and wheels by driving");
  drive->footer(kHelp);
  drive->add_option("RECORDING", command->recording, "the folder of a recorded drive");
  drive->add_option("--out", command->out, "the folder to write");
  drive->add_option("--distance", command->distance_m, "from the first place to the last, m")
      ->check(CLI::PositiveNumber);
  drive->add_option("--ceiling", command->ceiling_m, "its height above the floor, m")
      ->check(CLI::PositiveNumber);
  drive->add_option("--write", command->write_to,
                    "take mount and wheels over into this zenith.toml, or this recording's folder");
  drive->add_flag("--guide", command->guide, "say how to drive");
  drive->add_flag("--force", command->force, "replace an older output");
  drive->callback([command, &exit_code] { exit_code = run_drive(*command); });
}

}  // namespace zenith::tools
