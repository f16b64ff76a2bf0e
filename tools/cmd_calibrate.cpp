// zenith calibrate: the numbers that a robot's maker does not know.

#include "tools/calibrate/commands.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(In this order:
  zenith calibrate board --out board.pdf                   print it, glue it to a stiff plate
  zenith calibrate lens --camera /dev/video0 --out lens    hold it before the camera
  zenith calibrate drive --guide                           then record a drive, and
  zenith calibrate drive rec/drive --out drive --distance 3.21

With a lens that another program calibrated:
  zenith calibrate import camchain.yaml --write zenith.toml

Without a camera and a robot:
  zenith calibrate sample --out views
  zenith calibrate lens views/*.png --out lens
  zenith sim calibration --out rec
  zenith calibrate drive rec/r1 --out drive

docs/calibration.md explains each step.)";

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "Calibrate lens, mount and wheels");
  calibrate->footer(kHelp);
  calibrate->require_subcommand(1);
  add_calibrate_board(*calibrate, exit_code);
  add_calibrate_import(*calibrate, exit_code);
  add_calibrate_lens(*calibrate, exit_code);
  add_calibrate_drive(*calibrate, exit_code);
  add_calibrate_sample(*calibrate, exit_code);
}

}  // namespace zenith::tools
