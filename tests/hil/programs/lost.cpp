// hil-lost, on the host: how much mapping a power cut has cost, from what the daemon told before it
// (hil-watch record) and what the next one said that it has read from the disk.
//
// Lost is what was mapped between the first landmark that the disk lacks and the cut. Telemetry
// tells of each new landmark at once, and of the last checkpoint once a second.

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace {

constexpr int kOwnMap = -1;  // `peer` of lines of type landmarks
constexpr std::size_t kNumbersOfALandmark = 9;

struct Checkpoint {
  std::string place;  // empty: none was told
  std::uint64_t number = 0;
  double written_s = 0.0;
};

struct Life {
  std::vector<double> landmarks_s;  // when each one was first told
  double began_s = -1.0;
  double ended_s = 0.0;
  Checkpoint last;
  std::uint64_t last_of_map = 0;  // the last one of the place "map" that was told
};

Life read_life(const char* path) {
  Life life;
  std::set<std::int64_t> known;
  std::ifstream in(path);
  std::string text;
  while (std::getline(in, text)) {
    const nlohmann::json line = nlohmann::json::parse(text, nullptr, false);
    if (!line.is_object()) continue;  // cut in the middle
    const double heard_s = static_cast<double>(line.value("heard_ns", std::int64_t{0})) * 1e-9;
    const std::string type = line.value("type", "");
    life.ended_s = heard_s;
    if (life.began_s < 0.0) life.began_s = heard_s;
    if (type == "landmarks" && line.value("peer", 0) == kOwnMap) {
      const nlohmann::json& rows = line["rows"];
      for (std::size_t i = 0; i < rows.size(); i += kNumbersOfALandmark) {
        if (known.insert(rows[i].get<std::int64_t>()).second) life.landmarks_s.push_back(heard_s);
      }
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
  for (const double landmark_s : life.landmarks_s) {
    if (landmark_s > written_s) return life.ended_s - landmark_s;
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
  if (life.began_s < 0.0) {
    std::fprintf(stderr, "hil-lost: %s: no telemetry\n", argv[1]);
    return 2;
  }
  const auto number = [&](const std::string& place) {
    const auto at = found.find(place);
    return at == found.end() ? 0 : at->second;
  };
  double written_s = life.began_s;
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
