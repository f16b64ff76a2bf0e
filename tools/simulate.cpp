#include "tools/simulate.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include <nlohmann/json.hpp>

#include "platform/config/words.h"
#include "platform/recording/writer.h"
#include "sim/simulation.h"
#include "tools/atomic_output.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;

struct Shared {
  std::atomic<int> frames_done = 0;
  std::atomic<bool> failed = false;
  int frames_total = 0;
  const std::function<void(double)>* progress = nullptr;
};

Status write_drive(sim::RobotDrive drive, const fs::path& folder, Shared& shared) {
  auto writer = RecordingWriter::create(folder, drive.config(), {});
  if (!writer.ok()) return writer.error();
  const Lens& lens = drive.config().lens;
  sim::SimFrame frame;
  std::vector<CanFrame> can;
  while (!shared.failed && drive.next(frame, can)) {
    const ImageView image{frame.pixels.data(), lens.width_px, lens.height_px, lens.width_px};
    if (const Status added = writer->add_frame(frame.stamp, image); !added) return added;
    for (const CanFrame& message : can) writer->add_can(message);
    writer->add_truth(frame.stamp, frame.T_world_robot);
    const double done = ++shared.frames_done;
    if (*shared.progress) (*shared.progress)(done / shared.frames_total);
  }
  return writer->finish();
}

std::string provenance(const sim::Simulation& simulation, const SimulatePlan& plan) {
  const nlohmann::json json = {{"zenith", ZENITH_VERSION},
                               {"world", simulation.name()},
                               {"seed", plan.seed},
                               {"duration_s", plan.duration_s},
                               {"max_view_angle_deg", plan.max_view_angle_deg}};
  return json.dump(2) + "\n";
}

}  // namespace

Status check_worlds(const std::vector<std::string>& worlds) {
  const std::vector<std::string> known = sim::list_worlds();
  std::string problems;
  for (const std::string& world : worlds) {
    std::error_code code;
    if (fs::is_regular_file(sim::find_world(world), code)) continue;
    problems += (problems.empty() ? "" : "\n") + ("no world '" + world + "'");
    for (const std::string& near : nearest_words(world, known)) problems += ", near: " + near;
    problems += "; `zenith sim --list` tells them, a file's path works too";
  }
  if (!problems.empty()) return Error{problems};
  return {};
}

Result<std::vector<std::string>> write_simulation(const SimulatePlan& plan, const fs::path& folder,
                                                  const std::function<void(double)>& progress) {
  const sim::SimOptions options{plan.seed, plan.duration_s, plan.max_view_angle_deg};
  const auto simulation = sim::Simulation::load(sim::find_world(plan.world), options);
  if (!simulation.ok()) return simulation.error();
  const std::size_t robots = simulation->robot_count();
  Shared shared;
  shared.progress = &progress;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < robots; ++i) {
    const sim::RobotDrive drive = simulation->drive(i);
    names.push_back(drive.name());
    shared.frames_total += drive.frame_count();
  }
  std::vector<Status> written(robots);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < robots; i = next++) {
      written[i] = write_drive(simulation->drive(i), folder / names[i], shared);
      if (!written[i]) shared.failed = true;
    }
  };
  {
    std::vector<std::jthread> threads;
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    for (std::size_t i = 1; i < std::min(cores, robots); ++i) threads.emplace_back(work);
    work();
  }
  for (const Status& status : written) {
    if (!status) return status.error();
  }
  const Status noted = write_file(folder / "simulation.json", provenance(*simulation, plan));
  if (!noted) return noted.error();
  return names;
}

}  // namespace zenith::tools
