// zenith calibrate import: a lens that another program calibrated.

#include <cstdio>
#include <memory>

#include "platform/config/lens_settings.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/import.h"
#include "tools/calibrate/result_files.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Reads the calibration of a lens: Kalibr's camchain.yaml, OpenCV's yaml, ROS's
camera_info yaml, Basalt's json. The lens is taken as it is, in its own model: the table of models is
in docs/calibration.md. What no camera can have is refused with the reason.

OpenCV's files do not say which model they mean: four coefficients are taken for cv::fisheye's.

Examples:
  zenith calibrate import camchain.yaml --write zenith.toml
  zenith calibrate import stereo.yaml --camera cam1 --sensor sensor.yaml
  zenith calibrate import calibration.yml --size 640x480)";

struct ImportCommand {
  std::string file;
  std::string camera;
  std::string size;
  std::string sensor;
  std::string write_to;
};

Result<ForeignLens> choose(const std::vector<ForeignLens>& lenses, const std::string& camera) {
  if (camera.empty() && lenses.size() == 1) return lenses.front();
  std::string names;
  for (const ForeignLens& lens : lenses) {
    if (lens.camera == camera) return lens;
    names += (names.empty() ? "" : ", ") + lens.camera;
  }
  return Error{"the file has the cameras " + names + "; choose one with --camera"};
}

int run_import(const ImportCommand& command) {
  const auto lenses = read_foreign_lenses(command.file);
  if (!lenses) return fail(lenses.error());
  auto chosen = choose(*lenses, command.camera);
  if (!chosen) return fail({command.file + ": " + chosen.error().message});
  if (!command.size.empty() &&
      std::sscanf(command.size.c_str(), "%dx%d", &chosen->width_px, &chosen->height_px) != 2) {
    return fail({"expected --size WIDTHxHEIGHT, found '" + command.size + "'"}) + 1;
  }
  if (chosen->width_px == 0) {
    return fail({command.file + ": says no image size; say it: --size WIDTHxHEIGHT"});
  }
  const auto imported = import_lens(*chosen);
  if (!imported) return fail({command.file + ": " + imported.error().message});
  const Lens& lens = imported->lens;
  std::printf("%s, %s, %d x %d pixels, out to %.0f degrees\n", chosen->format.c_str(),
              chosen->model.c_str(), lens.width_px, lens.height_px, imported->widest_deg);
  std::printf("%s\n", lens_text(lens).c_str());
  if (!imported->note.empty()) warn({imported->note});
  if (imported->widest_deg < 50.0) {
    warn({"the lens is narrow: a wider one sees more of the ceiling, and the map needs it"});
  }
  Status done;
  if (!command.sensor.empty()) done = write_sensor_file(command.sensor, lens);
  if (done && !command.write_to.empty()) done = write_lens(command.write_to, lens);
  return done ? 0 : fail(done.error());
}

}  // namespace

void add_calibrate_import(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<ImportCommand>();
  CLI::App* import = calibrate.add_subcommand("import", "Read a lens calibrated elsewhere");
  import->footer(kHelp);
  import->add_option("FILE", command->file, "the calibration")->required();
  import->add_option("--camera", command->camera, "which one, of a file with several");
  import->add_option("--size", command->size, "of the images, when the file does not say it");
  import->add_option("--sensor", command->sensor, "write a recording's sensor.yaml");
  import->add_option("--write", command->write_to,
                     "take the lens over into this zenith.toml, or this recording's folder");
  import->callback([command, &exit_code] { exit_code = run_import(*command);
});
}  // namespace zenith::tools

}  // namespace zenith::tools
