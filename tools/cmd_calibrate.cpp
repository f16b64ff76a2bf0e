// zenith calibrate: the numbers that a robot's maker does not know.

#include "tools/calibrate/commands.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(In this order:
  zenith calibrate board --out board.pdf                   print it, glue it to a stiff plate
  zenith calibrate lens --camera /dev/video0 --out lens    hold it before the camera

Without a camera:
  zenith calibrate sample --out views
  zenith calibrate lens views/*.png --out lens

docs/calibration.md explains each step.)";

}  // namespace

void add_calibrate_command(CLI::App& app, int& exit_code) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "Calibrate lens, mount and wheels");
  calibrate->footer(kHelp);
  calibrate->require_subcommand(1);
  add_calibrate_board(*calibrate, exit_code);
  add_calibrate_lens(*calibrate, exit_code);
  add_calibrate_sample(*calibrate, exit_code);
}

}  // namespace zenith::tools
