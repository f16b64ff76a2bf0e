// zenith calibrate lens: the fisheye lens, from images of a board or from a live camera.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <opencv2/imgcodecs.hpp>

#include "drivers/camera/v4l2_camera.h"
#include "platform/linux/signals.h"
#include "tools/atomic_output.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/lens_pictures.h"
#include "tools/calibrate/live.h"
#include "tools/calibrate/result_files.h"
#include "tools/commands.h"
#include "tools/picture_file.h"
#include "tools/progress.h"
#include "tools/report/canvas.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHelp =
    R"(Finds the lens (focal lengths, centre, k1 .. k4 of the equidistant model) from images of a
board that was held before the camera: 20 to 40 of them, over the whole image and up to its rim,
near and far, leaning to all sides. Bad images are left out and named. OUT holds sensor.yaml,
coverage.png (where to hold the board next), residuals.png and report.txt; the verdict says whether
it can be used.

With --camera the images come live, and the program says where to hold the board. Stop zenithd
first: a camera serves one program.

--write takes the lens over: into a configuration (zenith.toml; all else in it stays) or into the
folder of a recording. A lens judged "do again" is not taken over.

Examples:
  zenith calibrate lens views/*.png --out lens
  zenith calibrate lens --camera /dev/video0 --out lens
  zenith calibrate lens lens/views/*.png --out again --write zenith.toml

docs/calibration.md explains more.)";

struct LensCommand {
  TargetOptions target;
  std::vector<std::string> images;
  std::string camera;
  std::string size = "640x480";
  int views = 40;
  std::string out;
  std::string write_to;
  bool force = false;
};

struct Boards {
  std::vector<SeenBoard> seen;
  int width_px = 0;
  int height_px = 0;
};

// Files, and all files of folders; sorted, so that the same files give the same result.
std::vector<fs::path> image_files(const std::vector<std::string>& named) {
  std::vector<fs::path> files;
  for (const std::string& name : named) {
    std::error_code code;
    if (!fs::is_directory(name, code)) {
      files.emplace_back(name);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(name, code)) {
      if (is_picture(entry.path())) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Result<Detection> detect_in(const cv::Mat& image, const Target& target, Boards& boards) {
  if (boards.width_px == 0) {
    boards.width_px = image.cols;
    boards.height_px = image.rows;
  }
  if (image.cols != boards.width_px || image.rows != boards.height_px) {
    return Error{std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                 " pixels, expected those of the first image: " + std::to_string(boards.width_px) +
                 "x" + std::to_string(boards.height_px)};
  }
  return detect_target(image, target);
}

Boards boards_of_files(const std::vector<fs::path>& files, const Target& target) {
  Boards boards;
  Progress progress("looking for the board");
  for (const fs::path& file : files) {
    const auto image = read_grey_picture(file);
    boards.seen.push_back(
        {file.filename().string(), image ? detect_in(*image, target, boards) : image.error()});
    progress.update(static_cast<double>(boards.seen.size()) / static_cast<double>(files.size()));
  }
  return boards;
}

Result<Boards> boards_of_camera(const LensCommand& command, const Target& target,
                                const fs::path& out) {
  V4l2Settings settings;
  settings.device = command.camera;
  if (std::sscanf(command.size.c_str(), "%dx%d", &settings.width, &settings.height) != 2) {
    return Error{"expected --size WIDTHxHEIGHT, such as 640x480, found '" + command.size + "'"};
  }
  Signals signals;
  if (const Status opened = signals.open(); !opened) return opened.error();
  V4l2Camera camera(settings);
  LivePlan plan;
  plan.target = target;
  plan.views = command.views;
  const auto views = collect_views(
      camera, plan, [&signals] { return signals.wait({0}) == SignalRequest::kStop; },
      [](const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); });
  if (!views) return views.error();
  Boards boards;
  boards.width_px = settings.width;
  boards.height_px = settings.height;
  fs::create_directories(out / "views");
  for (const LiveView& view : *views) {
    const std::string name = view.board.name + ".png";
    const Status kept = write_picture(out / "views" / name, view.image);
    if (!kept) return kept.error();
    boards.seen.push_back(view.board);
  }
  return boards;
}

Status write_result(const LensCalibration& c, const std::string& report, const fs::path& folder) {
  Status done = write_file(folder / "report.txt", report);
  if (done) done = write_sensor_file(folder / "sensor.yaml", c.fit.lens);
  if (done) done = draw_coverage(c, folder / "coverage.png");
  if (done) done = draw_residuals(c, folder / "residuals.png");
  return done;
}

int take_over(const LensCommand& command, const LensCalibration& c) {
  if (c.judgement.worth == Worth::kAgain) {
    if (!command.write_to.empty()) {
      return fail({command.write_to + ": left as it was: the lens is not good enough"});
    }
    return 1;
  }
  if (command.write_to.empty()) return 0;
  if (const Status written = write_lens(command.write_to, c.fit.lens); !written) {
    return fail(written.error());
  }
  std::printf("%s: the lens was taken over\n", command.write_to.c_str());
  return 0;
}

int run_lens(const LensCommand& command) {
  const auto target = command.target.target();
  if (!target) return fail(target.error()) + 1;
  if (command.images.empty() == command.camera.empty()) {
    return fail({"calibrate lens needs images, or --camera DEVICE"}) + 1;
  }
  auto output = AtomicFolder::create(command.out, command.force, "report.txt");
  if (!output) return fail(output.error());
  const auto boards = command.camera.empty()
                          ? Result<Boards>(boards_of_files(image_files(command.images), *target))
                          : boards_of_camera(command, *target, output->path());
  if (!boards) return fail(boards.error());
  const auto c = calibrate_lens(boards->seen, *target, boards->width_px, boards->height_px);
  if (!c) return fail(c.error());
  const std::string report = lens_report(*c);
  Status done = write_result(*c, report, output->path());
  if (done) done = output->commit();
  if (!done) return fail(done.error());
  std::printf("%s%s\n", report.c_str(), command.out.c_str());
  return take_over(command, *c);
}

}  // namespace

void add_calibrate_lens(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<LensCommand>();
  CLI::App* lens = calibrate.add_subcommand("lens", "Calibrate the lens with a board");
  lens->footer(kHelp);
  lens->add_option("IMAGES", command->images, "images of the board, or folders of them");
  command->target.add_to(*lens);
  lens->add_option("--camera", command->camera, "take the images live from this V4L2 camera");
  lens->add_option("--size", command->size, "of the live frames")->capture_default_str();
  lens->add_option("--views", command->views, "live images at most")
      ->check(CLI::Range(8, 200))
      ->capture_default_str();
  lens->add_option("--out", command->out, "the folder to write")->required();
  lens->add_option("--write", command->write_to,
                   "take the lens over into this zenith.toml, or this recording's folder");
  lens->add_flag("--force", command->force, "replace an older output");
  lens->callback([command, &exit_code] { exit_code = run_lens(*command); });
}

}  // namespace zenith::tools
