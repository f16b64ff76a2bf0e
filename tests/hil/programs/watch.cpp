// hil-watch, in a guest: reads a daemon's telemetry (docs/daemon.md) and waits for what is
// expected of it.

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "platform/base/result.h"
#include "platform/linux/clock.h"
#include "tests/hil/programs/condition.h"
#include "tests/hil/programs/play_folder.h"
#include "tests/support/line_reader.h"

namespace zenith::hil {
namespace {

using nlohmann::json;

constexpr const char* kUsage =
    R"(Usage: hil-watch SOCKET [OPTIONS] until SECONDS CONDITION...
       hil-watch SOCKET [OPTIONS] get SECONDS KEY...
       hil-watch SOCKET [OPTIONS] record FILE

until   waits until the newest line of each type meets all its conditions; says which are not met
get     prints values out of the next lines, separated by spaces
record  writes all lines until the daemon ends

CONDITION is KEY and = != >= <= > < and a value; KEY is type.name: health.camera.up=true

  --truth PLAY       adds error_m and error_deg to pose lines: against the play's truth;
  --origin FILE      when the play began, written by hil-play
  --peer-truth PLAY  adds error_m and error_deg to alignment lines
  --map-truth PLAY   adds map_error_m and map_error_deg to pose lines with a map_pose: the stored map was
                     begun where this play begins
)";

struct Options {
  std::string socket;
  std::string truth;
  std::string origin;
  std::string peer_truth;
  std::string map_truth;
  std::string verb;
  std::vector<std::string> words;
};

// Puts what is true beside what the daemon says.
class Judge {
 public:
  static Result<Judge> make(const Options& options) {
    Judge judge;
    judge.origin_file_ = options.origin;
    if (options.truth.empty()) return judge;
    auto truth = read_truth(options.truth);
    if (!truth) return truth.error();
    judge.truth_ = std::move(*truth);
    const auto own = read_start(options.truth);
    if (!own) return own.error();
    if (!options.peer_truth.empty()) {
      const auto peer = read_start(options.peer_truth);
      if (!peer) return peer.error();
      judge.T_own_peer_ = own->inverse() * *peer;
    }
    if (!options.map_truth.empty()) {
      const auto map = read_start(options.map_truth);
      if (!map) return map.error();
      judge.T_map_own_ = map->inverse() * *own;
    }
    return judge;
  }

  void add_errors(json& line) {
    const std::string type = line.value("type", "");
    const auto pose = pose_of(line, "pose");
    if (!pose) return;
    if (type == "alignment" && T_own_peer_) add(line, *pose, *T_own_peer_, "");
    if (type != "pose" || truth_.empty()) return;
    if (origin_ns_ == 0 && !(std::ifstream(origin_file_) >> origin_ns_)) return;
    const std::int64_t time = line["stamp_ns"].get<std::int64_t>() - origin_ns_;
    const Pose2 truth = truth_at(truth_, time);
    add(line, *pose, truth, "");
    line["play_s"] = static_cast<double>(time) * 1e-9;
    const auto map_pose = pose_of(line, "map_pose");
    if (map_pose && T_map_own_) add(line, *map_pose, *T_map_own_ * truth, "map_");
  }

 private:
  static std::optional<Pose2> pose_of(const json& line, const char* key) {
    const auto value = line.find(key);
    if (value == line.end() || !value->is_array() || value->size() != 3) return std::nullopt;
    if (!(*value)[0].is_number()) return std::nullopt;
    return Pose2{(*value)[0], (*value)[1], (*value)[2]};
  }

  static void add(json& line, const Pose2& is, const Pose2& truth, const std::string& what) {
    line[what + "error_m"] = std::hypot(is.x_m - truth.x_m, is.y_m - truth.y_m);
    line[what + "error_deg"] =
        std::abs(wrap_angle(is.theta_rad - truth.theta_rad)) * 180.0 / std::numbers::pi;
    line[what + "truth"] = {truth.x_m, truth.y_m, truth.theta_rad};
  }

  std::vector<TruePose> truth_;
  std::string origin_file_;
  std::int64_t origin_ns_ = 0;
  std::optional<Pose2> T_own_peer_;
  std::optional<Pose2> T_map_own_;
};

// Lines of telemetry until a moment.
class Lines {
 public:
  Lines(const Options& options, Judge judge, double limit_s)
      : judge_(std::move(judge)),
        started_(monotonic_now()),
        limit_(started_ + Duration::from_seconds(limit_s)),
        reader_(options.socket) {
    while (!reader_.connected() && monotonic_now() < limit_) {  // the daemon may be starting
      sleep_until(monotonic_now() + Duration{50'000'000});
      reader_.connect(options.socket);
    }
  }

  bool connected() const { return reader_.connected(); }
  bool daemon_left() const { return left_; }
  double passed_s() const { return (monotonic_now() - started_).seconds(); }

  // False at the end of the time, or when the daemon has left.
  bool next(json& line) {
    while (reader_.connected() && monotonic_now() < limit_) {
      const std::string text = reader_.next(limit_ - monotonic_now());
      if (text.empty()) {
        left_ = reader_.ended();
        if (left_) return false;
        continue;
      }
      line = json::parse(text, nullptr, false);
      if (!line.is_object()) {
        std::fprintf(stderr, "hil-watch: no JSON object: %s\n", text.c_str());
        continue;
      }
      judge_.add_errors(line);
      return true;
    }
    return false;
  }

 private:
  Judge judge_;
  Time started_;
  Time limit_;
  LineReader reader_;
  bool left_ = false;
};

const char* why_no_more(const Lines& lines) {
  if (!lines.connected()) return "nobody listens on the telemetry socket";
  return lines.daemon_left() ? "the daemon has ended" : "time is up";
}

int until(Lines& lines, const std::vector<Condition>& conditions) {
  std::map<std::string, json> newest;
  const auto value = [&newest](const Condition& c) {
    const auto line = newest.find(c.type);
    return line == newest.end() ? nullptr : find_value(line->second, c.path);
  };
  const auto met = [&newest](const Condition& c) {
    const auto line = newest.find(c.type);
    return line != newest.end() && c.met_by(line->second);
  };
  json line;
  while (lines.next(line)) {
    newest[line.value("type", "")] = line;
    bool all = true;
    for (const Condition& c : conditions) all &= met(c);
    if (!all) continue;
    std::printf("%.1f s:", lines.passed_s());
    for (const Condition& c : conditions) {
      std::printf(" %s (%s)", c.text.c_str(), value_text(value(c)).c_str());
    }
    std::printf("\n");
    return 0;
  }
  std::printf("NOT within %.1f s (%s):\n", lines.passed_s(), why_no_more(lines));
  for (const Condition& c : conditions) {
    std::printf("    %s %s: it is %s\n", met(c) ? "met:    " : "NOT met:", c.text.c_str(),
                value_text(value(c)).c_str());
  }
  for (const auto& [type, last] : newest) std::printf("    last %s\n", last.dump().c_str());
  return 1;
}

int get(Lines& lines, const std::vector<std::string>& keys) {
  std::map<std::string, std::string> found;
  json line;
  while (found.size() < keys.size() && lines.next(line)) {
    for (const std::string& key : keys) {
      const std::size_t dot = key.find('.');
      if (key.substr(0, dot) != line.value("type", "")) continue;
      const json* value = find_value(line, key.substr(dot + 1));
      if (value != nullptr) found[key] = value_text(value);
    }
  }
  for (const std::string& key : keys) {
    if (found.count(key) == 0) {
      std::fprintf(stderr, "hil-watch: no %s: %s\n", key.c_str(), why_no_more(lines));
      return 1;
    }
    std::printf("%s ", found[key].c_str());
  }
  std::printf("\n");
  return 0;
}

int record(Lines& lines, const std::string& path) {
  std::ofstream out(path);
  json line;
  while (lines.next(line)) {
    line["heard_ns"] = monotonic_now().ns;
    out << line.dump() << std::endl;
  }
  return 0;
}

bool read_options(int argc, char** argv, Options& options) {
  if (argc < 3) return false;
  options.socket = argv[1];
  int i = 2;
  for (; i + 1 < argc && std::string_view(argv[i]).substr(0, 2) == "--"; i += 2) {
    const std::string_view word = argv[i];
    if (word == "--truth") {
      options.truth = argv[i + 1];
    } else if (word == "--origin") {
      options.origin = argv[i + 1];
    } else if (word == "--peer-truth") {
      options.peer_truth = argv[i + 1];
    } else if (word == "--map-truth") {
      options.map_truth = argv[i + 1];
    } else {
      return false;
    }
  }
  if (i < argc) options.verb = argv[i++];
  options.words.assign(argv + i, argv + argc);
  const std::size_t least = options.verb == "record" ? 1 : 2;
  return options.words.size() >= least &&
         (options.verb == "until" || options.verb == "get" || options.verb == "record");
}

int run(const Options& options) {
  auto judge = Judge::make(options);
  if (!judge) {
    std::fprintf(stderr, "hil-watch: %s\n", judge.error().message.c_str());
    return 2;
  }
  constexpr double kLong_s = 86400.0;
  if (options.verb == "record") {
    Lines lines(options, std::move(*judge), kLong_s);
    return record(lines, options.words[0]);
  }
  const double limit_s = std::strtod(options.words[0].c_str(), nullptr);
  const std::vector<std::string> rest(options.words.begin() + 1, options.words.end());
  std::vector<Condition> conditions;
  for (const std::string& word : rest) {
    if (options.verb == "get") break;
    const auto condition = Condition::parse(word);
    if (!condition) {
      std::fprintf(stderr, "hil-watch: '%s' is no condition\n", word.c_str());
      return 2;
    }
    conditions.push_back(*condition);
  }
  Lines lines(options, std::move(*judge), limit_s);
  return options.verb == "get" ? get(lines, rest) : until(lines, conditions);
}

}  // namespace
}  // namespace zenith::hil

int main(int argc, char** argv) {
  zenith::hil::Options options;
  if (!zenith::hil::read_options(argc, argv, options)) {
    std::fputs(zenith::hil::kUsage, stderr);
    return 2;
  }
  return zenith::hil::run(options);
}
