// hil-lights, in a guest: reads a light off the other side of a simulated GPIO chip, and waits
// until it shows a state.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "platform/linux/clock.h"
#include "tests/hil/programs/rhythm.h"

int main(int argc, char** argv) {
  using namespace zenith;
  if (argc != 4) {
    std::fprintf(stderr,
                 "Usage: hil-lights VALUE_FILE SECONDS STATE\n\n"
                 "Waits so long until the light shows STATE: starting, mapping, merged, degraded,\n"
                 "fault, dark.\n");
    return 2;
  }
  const std::string path = argv[1];
  const std::string expected = argv[3];
  const Time started = monotonic_now();
  const Time limit = started + Duration::from_seconds(std::atof(argv[2]));
  std::vector<hil::LightChange> changes;
  std::string shown = "unclear";
  for (Time now = started; now < limit; now = monotonic_now()) {
    char value = 0;
    if (!(std::ifstream(path) >> value)) {
      std::fprintf(stderr, "hil-lights: cannot read %s\n", path.c_str());
      return 2;
    }
    const bool lit = value == '1';
    if (changes.empty() || changes.back().lit != lit) changes.push_back({now, lit});
    shown = hil::read_rhythm(changes, now);
    if (shown == expected) {
      std::printf("%.1f s: the light shows %s\n", (now - started).seconds(), shown.c_str());
      return 0;
    }
    sleep_until(now + Duration{10'000'000});
  }
  std::printf("NOT within %s s: the light shows %s, not %s\n", argv[2], shown.c_str(),
              expected.c_str());
  for (const hil::LightChange& change : changes) {
    std::printf("    %.2f s %s\n", (change.at - started).seconds(), change.lit ? "lit" : "dark");
  }
  return 1;
}
