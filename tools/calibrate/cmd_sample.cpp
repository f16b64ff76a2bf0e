// zenith calibrate sample: images to try the calibration of a lens with.

#include <cstdio>
#include <memory>

#include "tools/atomic_output.h"
#include "tools/calibrate/commands.h"
#include "tools/calibrate/sample.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Renders images of a board as a made-up fisheye lens of 190 degrees sees it (640 x 480 pixels,
blurred and noisy like a real camera's), and the true lens as truth.yaml.

Examples:
  zenith calibrate sample --out views
  zenith calibrate lens views/*.png --out lens
  zenith calibrate sample --out views --seed 7 --target charuco --squares 6x4 --square-mm 60)";

struct SampleCommand {
  TargetOptions target;
  SamplePlan plan;
  std::string out;
  bool force = false;
};

int run_sample(SampleCommand& command) {
  const auto target = command.target.target();
  if (!target) return fail(target.error()) + 1;
  command.plan.target = *target;
  auto output = AtomicFolder::create(command.out, command.force, "truth.yaml");
  if (!output) return fail(output.error());
  Status done = write_samples(command.plan, output->path());
  if (done) done = output->commit();
  if (!done) return fail(done.error());
  std::printf("%d images of a %s in %s\n", command.plan.views, target_text(*target).c_str(),
              command.out.c_str());
  return 0;
}

}  // namespace

void add_calibrate_sample(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<SampleCommand>();
  CLI::App* sample = calibrate.add_subcommand("sample", "Render images of a board");
  sample->footer(kHelp);
  command->target.add_to(*sample);
  sample->add_option("--out", command->out, "the folder to write")->required();
  sample->add_option("--views", command->plan.views, "how many images")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sample->add_option("--seed", command->plan.seed, "decides the lens, the views and the noise")
      ->capture_default_str();
  sample->add_flag("--force", command->force, "replace an older output");
  sample->callback([command, &exit_code] { exit_code = run_sample(*command); });
}

}  // namespace zenith::tools
