#include "tests/bench/rendered_drive.h"

#include <cstdio>
#include <cstdlib>

#include "tools/runner/simulated_source.h"

namespace zenith::bench {
namespace {

constexpr double kDuration_s = 30.0;

RenderedDrive render() {
  const auto team = tools::simulate_team("corridor-rooms", 1, kDuration_s, Parameters{});
  if (!team.ok()) {
    std::fprintf(stderr, "%s\n", team.error().message.c_str());
    std::exit(1);
  }
  Source& source = *team->sources.front();
  RenderedDrive drive;
  drive.robot = source.config();
  SourceFrame frame;
  for (;;) {
    const Result<bool> more = source.next(frame);
    if (!more.ok() || !*more) break;
    drive.frames.push_back({frame.stamp, frame.pixels, frame.wheels});
  }
  return drive;
}

}  // namespace

const RenderedDrive& corridor_rooms() {
  static const RenderedDrive drive = render();
  return drive;
}

}  // namespace zenith::bench
