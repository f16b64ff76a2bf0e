// zenith calibrate import: a lens that another program calibrated.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>

#include "platform/config/lens_settings.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/import/foreign_lens.h"
#include "tools/calibrate/import/lens_picture.h"
#include "tools/calibrate/import/native_lens.h"
#include "tools/calibrate/result_files.h"
#include "tools/commands.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Reads a lens that was calibrated elsewhere, and shows what it understood. Nothing is fitted:
the lens keeps its own model and its own numbers. What no lens here can be is refused with the reason.

Formats: Kalibr (camchain, results-cam.txt), ROS camera_info (the file, what `topic echo` prints,
ost.txt), OpenCV (YAML, XML, JSON; stereo files), Basalt, VINS (camodocal), ORB-SLAM, OCamCalib, SVO,
OKVIS, MRPT, COLMAP, DSO. Which one it is, is found by what stands in the file.

--size is for files that do not say it. Where the robot's images are binned or scaled ones of those
that were calibrated, --scale says by how much: 0.5 for half as wide. --scale 1 says that an optical
axis far from the middle is meant.

Four coefficients without a model's name are a pinhole's k1 k2 p1 p2; --model fisheye says that they
are cv::fisheye's k1 k2 k3 k4.

Examples:
  zenith calibrate import camchain.yaml
  zenith calibrate import camchain.yaml --camera cam1 --write zenith.toml
  zenith calibrate import calibration.xml --size 640x480 --model fisheye
  zenith calibrate import ost.yaml --picture lens.png --image view.png)";

struct ImportCommand {
  std::string file;
  std::string camera;
  std::string size;
  double scale = 0.0;  // 0: not said
  std::string model;
  std::string sensor;
  std::string write_to;
  std::string picture;
  std::string image;
};

Result<std::pair<int, int>> parse_size(const std::string& text) {
  std::pair<int, int> size;
  const char* end = text.data() + text.size();
  const auto [x, first] = std::from_chars(text.data(), end, size.first);
  if (first == std::errc() && x != end && *x == 'x') {
    const auto [rest, second] = std::from_chars(x + 1, end, size.second);
    if (second == std::errc() && rest == end && size.first > 0 && size.second > 0) return size;
  }
  return Error{"expected --size WIDTHxHEIGHT, as in 640x480, found '" + text + "'"};
}

std::string size_of(const ForeignLens& lens) {
  return lens.lens.width_px == 0 ? "size not said"
                                 : formatted("%d x %d", lens.lens.width_px, lens.lens.height_px);
}

// What a file holds, a line for each camera.
void list_cameras(const std::vector<ForeignLens>& lenses) {
  for (const ForeignLens& lens : lenses) {
    std::printf("%-12s %s, %s: %s\n", lens.camera.c_str(), lens.format.c_str(),
                size_of(lens).c_str(),
                lens.refused.empty() ? lens.model.c_str() : ("refused: " + lens.refused).c_str());
  }
}

Result<ForeignLens> choose(const std::vector<ForeignLens>& lenses, const std::string& camera) {
  if (camera.empty() && lenses.size() == 1) return lenses.front();
  std::string names;
  for (const ForeignLens& lens : lenses) {
    if (!camera.empty() && lens.camera == camera) return lens;
    names += (names.empty() ? "" : ", ") + lens.camera;
  }
  list_cameras(lenses);
  return Error{camera.empty()
                   ? "the file has the cameras " + names + "; choose one with --camera"
                   : "there is no camera '" + camera + "' in the file" +
                         (names.empty() ? ", which has one without a name: leave out --camera"
                                        : ", it has " + names)};
}

std::string angle_text(const std::optional<double>& angle_deg) {
  return angle_deg ? formatted("%.1f degrees", *angle_deg) : "beyond where the lens's curve ends";
}

void print_row(const char* name, const std::string& value) {
  std::printf("%-14s %s\n", name, value.c_str());
}

// The section as a configuration has it.
void print_section(const Lens& lens) {
  std::printf("\n[lens]\n");
  Lens copy = lens;
  for (const Setting& setting : lens_settings(copy)) {
    const std::string key = split_key(setting.key).second;
    if (!lens_model_has(lens.model, key)) continue;
    std::printf("%s = %s\n", key.c_str(), toml_value(setting).c_str());
  }
  std::printf("\n");
}

void print_lens(const ForeignLens& foreign, const NativeLens& native) {
  const Lens& lens = native.lens;
  print_row("format", foreign.format);
  if (!foreign.camera.empty()) print_row("camera", foreign.camera);
  print_row("model", foreign.model);
  print_row("image", formatted("%d x %d pixels", lens.width_px, lens.height_px));
  const AngleOfView angles = angle_of_view(lens);
  print_row("angle of view", "horizontal " + angle_text(angles.horizontal_deg));
  print_row("", "vertical " + angle_text(angles.vertical_deg));
  print_row("", "diagonal " + angle_text(angles.diagonal_deg));
  for (const std::string& note : native.notes) print_row("note", note);
  print_section(lens);
}

// The files that were asked for.
Status write_files(const ImportCommand& command, const Lens& lens) {
  Status done;
  if (!command.picture.empty()) {
    done = draw_lens(lens, command.image, command.picture);
    if (done) print_row("picture", command.picture);
  }
  if (done && !command.sensor.empty()) {
    done = write_sensor_file(command.sensor, lens);
    if (done) print_row("written", command.sensor);
  }
  if (done && !command.write_to.empty()) {
    done = write_lens(command.write_to, lens);
    if (done) print_row("written", command.write_to + ", [lens]");
  }
  return done;
}

Result<SizeWish> wish_of(const ImportCommand& command) {
  SizeWish wish;
  if (!command.size.empty()) {
    const auto size = parse_size(command.size);
    if (!size) return size.error();
    wish.size = *size;
  }
  if (std::isnan(command.scale)) return Error{"expected a number for --scale, found nan"};
  if (command.scale != 0.0) wish.scale = command.scale;
  return wish;
}

int run_import(const ImportCommand& command) {
  const auto wish = wish_of(command);
  if (!wish) return fail(wish.error()) + 1;
  if (!command.image.empty() && command.picture.empty()) {
    return fail({"--image is drawn into a picture: say --picture FILE.png as well"}) + 1;
  }
  const ForeignModel model = command.model == "fisheye"   ? ForeignModel::kFisheye
                             : command.model == "pinhole" ? ForeignModel::kPinhole
                                                          : ForeignModel::kAsTheFileSays;
  const auto lenses = read_foreign_lenses(command.file, model);
  if (!lenses) return fail(lenses.error());
  const auto chosen = choose(*lenses, command.camera);
  if (!chosen) return fail({command.file + ": " + chosen.error().message});
  const auto native = native_lens(*chosen, *wish);
  if (!native) {
    return fail({command.file + (chosen->camera.empty() ? "" : ", " + chosen->camera) + ": " +
                 native.error().message});
  }
  print_lens(*chosen, *native);
  const AngleOfView angles = angle_of_view(native->lens);
  if (angles.diagonal_deg && *angles.diagonal_deg < 100.0) {
    warn({"the lens is narrow: a wider one sees more of the ceiling, and the map needs it"});
  }
  const Status done = write_files(command, native->lens);
  if (!done) return fail(done.error());
  if (command.write_to.empty() && command.sensor.empty()) {
    std::printf(
        "Nothing was written: --write zenith.toml takes the lens over, --picture lens.png "
        "shows it.\n");
  }
  return 0;
}

}  // namespace

void add_calibrate_import(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<ImportCommand>();
  CLI::App* import = calibrate.add_subcommand("import", "Read a lens calibrated elsewhere");
  import->footer(kHelp);
  import->add_option("FILE", command->file, "the calibration")->required();
  import->add_option("--camera", command->camera, "which one, of a file with several");
  import->add_option("--size", command->size, "of the images, when the file does not say it");
  import
      ->add_option("--scale", command->scale,
                   "pixels of the robot's images for one of the calibrated ones, along each side")
      ->check(CLI::Range(1.0 / 64.0, 64.0));
  import
      ->add_option("--model", command->model,
                   "what coefficients mean that the file does not name the model of")
      ->check(CLI::IsMember({"pinhole", "fisheye"}));
  import->add_option("--picture", command->picture,
                     "draw how the lens bends a ceiling of tiles: a .png");
  import->add_option("--image", command->image,
                     "an image of this camera, for the picture to stand upon");
  import->add_option("--sensor", command->sensor, "write a recording's sensor.yaml");
  import->add_option("--write", command->write_to,
                     "take the lens over into this zenith.toml, or this recording's folder");
  import->callback([command, &exit_code] { exit_code = run_import(*command);
});
}  // namespace zenith::tools

}  // namespace zenith::tools
