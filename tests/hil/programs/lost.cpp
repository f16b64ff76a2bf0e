// hil-lost, on the host: how much mapping a power cut has cost, from what the daemon told before it
// (hil-watch record) and the checkpoint that was found after it.
//
// Lost is what was mapped between the first landmark that the checkpoint lacks and the cut.
// Telemetry tells the number of landmarks once a second; the earlier of two lines counts.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace {

struct Second {
  double heard_s = 0.0;
  std::uint64_t landmarks = 0;  // established ones since the daemon's start
};

struct Life {
  std::vector<Second> seconds;
  double ended_s = 0.0;
  std::uint64_t last_checkpoint = 0;  // that the daemon reported as written
  double written_s = -1.0;            // the wanted one
};

Life read_life(const char* path, std::uint64_t checkpoint) {
  Life life;
  std::ifstream in(path);
  std::string text;
  while (std::getline(in, text)) {
    const nlohmann::json line = nlohmann::json::parse(text, nullptr, false);
    if (!line.is_object()) continue;  // cut in the middle
    const double heard_s = line.value("heard_ns", std::int64_t{0}) * 1e-9;
    const std::string type = line.value("type", "");
    life.ended_s = heard_s;
    if (type == "health") {
      life.seconds.push_back({heard_s, line["map"].value("promoted", std::uint64_t{0})});
    }
    if (type != "stored_map") continue;
    life.last_checkpoint = line.value("checkpoint", std::uint64_t{0});
    const double age_s = line.value("age_s", -1.0);
    if (life.last_checkpoint == checkpoint && age_s >= 0.0) life.written_s = heard_s - age_s;
  }
  return life;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(
        stderr,
        "Usage: hil-lost TELEMETRY CHECKPOINT\n\n"
        "Prints the seconds of mapping that CHECKPOINT lacks, of those that TELEMETRY, written\n"
        "by hil-watch record, tells of. Exit code 1: a checkpoint that was told is lost.\n");
    return 2;
  }
  const std::uint64_t checkpoint = std::strtoull(argv[2], nullptr, 10);
  Life life = read_life(argv[1], checkpoint);
  if (life.seconds.empty()) {
    std::fprintf(stderr, "hil-lost: %s: no line of health\n", argv[1]);
    return 2;
  }
  if (checkpoint < life.last_checkpoint) {
    std::printf("checkpoint %llu was told as written, %llu was found\n",
                static_cast<unsigned long long>(life.last_checkpoint),
                static_cast<unsigned long long>(checkpoint));
    return 1;
  }
  // One that was written after the last line lacks nothing that was told.
  if (checkpoint > life.last_checkpoint) life.written_s = life.ended_s;
  const Second* before = nullptr;  // the last line that the checkpoint holds
  for (const Second& second : life.seconds) {
    if (before != nullptr && second.heard_s > life.written_s &&
        second.landmarks > before->landmarks) {
      std::printf("%.1f\n", life.ended_s - before->heard_s);
      return 0;
    }
    before = &second;
  }
  std::printf("0.0\n");
  return 0;
}
