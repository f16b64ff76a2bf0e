// hil-lost, on the host: how much mapping a power cut has cost, from what the daemon told before it
// (hil-watch record) and what the next one said that it has read from the disk.
//
// Lost is what was mapped between the first landmark that the disk lacks and the cut. Telemetry
// tells the number of landmarks, and the last checkpoint, once a second; of the two lines around a
// new landmark the earlier one counts.

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace {

struct Second {
  double heard_s = 0.0;
  std::uint64_t landmarks = 0;  // established ones since the daemon's start
};

struct Checkpoint {
  std::string place;  // empty: none was told
  std::uint64_t number = 0;
  double written_s = 0.0;
};

struct Life {
  std::vector<Second> seconds;
  double ended_s = 0.0;
  Checkpoint last;
  std::uint64_t last_of_map = 0;  // the last one of the place "map" that was told
};

Life read_life(const char* path) {
  Life life;
  std::ifstream in(path);
  std::string text;
  while (std::getline(in, text)) {
    const nlohmann::json line = nlohmann::json::parse(text, nullptr, false);
    if (!line.is_object()) continue;  // cut in the middle
    const double heard_s = static_cast<double>(line.value("heard_ns", std::int64_t{0})) * 1e-9;
    const std::string type = line.value("type", "");
    life.ended_s = heard_s;
    if (type == "health") {
      life.seconds.push_back({heard_s, line["map"].value("promoted", std::uint64_t{0})});
    }
    const double age_s = line.value("age_s", -1.0);
    if (type != "stored_map" || age_s < 0.0) continue;
    life.last = {line.value("place", ""), line.value("checkpoint", std::uint64_t{0}),
                 heard_s - age_s};
    if (life.last.place == "map") life.last_of_map = life.last.number;
  }
  return life;
}

// Place -> checkpoint, out of the log of the daemon's start.
std::map<std::string, std::uint64_t> read_found(const char* path) {
  const std::regex loaded(R"(checkpoint (\d+), read in \d+ ms from (?:.*/)?(map|session-\d)-[01])");
  std::map<std::string, std::uint64_t> found;
  std::ifstream in(path);
  std::string text;
  while (std::getline(in, text)) {
    std::smatch match;
    if (std::regex_search(text, match, loaded)) found[match[2]] = std::stoull(match[1]);
  }
  return found;
}

double lost_after(const Life& life, double written_s) {
  const Second* before = nullptr;  // the last line that the disk holds
  for (const Second& second : life.seconds) {
    if (before != nullptr && second.heard_s > written_s && second.landmarks > before->landmarks) {
      return life.ended_s - before->heard_s;
    }
    before = &second;
  }
  return 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(
        stderr,
        "Usage: hil-lost TELEMETRY LOG\n\n"
        "Prints the seconds of mapping, of those that TELEMETRY tells of (written by hil-watch\n"
        "record), that the maps lack which the next daemon has read by its LOG. Exit code 1: a\n"
        "checkpoint that was told is missing.\n");
    return 2;
  }
  const Life life = read_life(argv[1]);
  const auto found = read_found(argv[2]);
  if (life.seconds.empty()) {
    std::fprintf(stderr, "hil-lost: %s: no line of health\n", argv[1]);
    return 2;
  }
  const auto number = [&](const std::string& place) {
    const auto at = found.find(place);
    return at == found.end() ? 0 : at->second;
  };
  double written_s = life.seconds.front().heard_s;
  if (!life.last.place.empty()) {
    const std::uint64_t there = number(life.last.place);
    written_s = there == life.last.number ? life.last.written_s : life.ended_s;
    // A session may have gone into the map after the last line.
    const bool joined = life.last.place != "map" && number("map") > life.last_of_map;
    if (there < life.last.number && !joined) {
      std::printf("%s: checkpoint %llu was told as written, %llu was found\n",
                  life.last.place.c_str(), static_cast<unsigned long long>(life.last.number),
                  static_cast<unsigned long long>(there));
      return 1;
    }
  }
  std::printf("%.1f\n", lost_after(life, written_s));
  return 0;
}
