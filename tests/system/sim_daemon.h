#pragma once
// One zenithd-sim of a fleet under test, and what it tells.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "platform/linux/clock.h"
#include "slam/geometry.h"
#include "tests/support/line_reader.h"
#include "tests/system/process.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {

// Set up so that a slow computer makes it slow, and nothing else: corners are not shed, a frame
// waits for its wheels.
class SimDaemon {
 public:
  // `radio`: lines of the section [radio]. `netns`: where it runs; empty: here.
  SimDaemon(const std::filesystem::path& folder, const std::string& robot, const std::string& radio,
            const std::string& netns = "")
      : name_(robot), netns_(netns), base_((folder / robot).string()) {
    tools::write_text(
        base_ + ".toml",
        "[robot]\nname = \"" + robot + "\"\n[camera]\ndriver = \"simulated\"\n[odometry]\n" +
            "driver = \"simulated\"\npatience_s = 1\n[telemetry]\nrate_hz = 2\nsocket = \"" +
            base_ +
            ".sock\"\n[realtime]\npriority = 0\nlock_memory = false\n[load]\ncorners_min = "
            "128\n[slam]\nparticles = 100\n" +
            "[record]\nenabled = false\n[radio]\nkey_file = \"fleet.key\"\n" + radio +
            "[simulation]\nworld = \"" ZENITH_SOURCE_DIR "/tests/system/worlds/one-room.toml\"\n" +
            "robot = \"" + robot + "\"\n");
  }

  // False when its telemetry does not come up.
  bool start() {
    reader_.reset();
    latest_.clear();
    alignments_.clear();
    peers_.clear();
    coming_.clear();
    peers_left_ = 0;
    std::vector<std::string> words = {ZENITHD_SIM, "--config", base_ + ".toml"};
    if (!netns_.empty()) {
      const std::vector<std::string> prefix = {"/usr/bin/env", "ip", "netns", "exec", netns_};
      words.insert(words.begin(), prefix.begin(), prefix.end());
    }
    process_ = std::make_unique<Process>(words, base_ + ".out", base_ + ".log");
    return wait_until(kPatience_s, [&] {
      auto reader = std::make_unique<LineReader>(base_ + ".sock");
      if (reader->connected()) reader_ = std::move(reader);
      return reader_ != nullptr;
    });
  }
  // From the next start on.
  void set_world(const std::filesystem::path& world) {
    std::string text = tools::read_text(base_ + ".toml");
    text.replace(text.find("world = "), std::string::npos,
                 "world = \"" + world.string() + "\"\nrobot = \"" + name_ + "\"\n");
    tools::write_text(base_ + ".toml", text);
  }
  // It reads its files again.
  void hang_up() { process_->send(SIGHUP); }
  int stop() {
    process_->send(SIGTERM);
    return process_->wait(kPatience_s);
  }
  void kill() {
    process_->send(SIGKILL);
    (void)process_->wait(kPatience_s);
  }

  // Takes in all lines that are there; false without any.
  bool listen() {
    bool heard = false;
    for (std::string text = reader_->next({0}); !text.empty(); text = reader_->next({0})) {
      heard = true;
      const auto line = nlohmann::json::parse(text, nullptr, false);
      if (line.is_object()) take_in(line);
    }
    return heard;
  }

  const std::string& name() const { return name_; }
  std::string log() const { return tools::read_text(base_ + ".log"); }
  bool logged(const std::string& text) const { return log().find(text) != std::string::npos; }
  // The latest line of a type; null before the first.
  nlohmann::json latest(const std::string& type) const {
    const auto found = latest_.find(type);
    return found == latest_.end() ? nlohmann::json() : found->second;
  }
  // What it knew, when it last told of all its peers, of a robot that it exchanges maps with; null
  // when that was none of them.
  nlohmann::json peer(const std::string& name) const {
    const auto found = peers_.find(name);
    return found == peers_.end() ? nlohmann::json() : found->second;
  }
  // The merged alignment with a robot's map.
  std::optional<Pose2> merged(const std::string& peer) const {
    for (const auto& [slot, line] : alignments_) {
      if (line["name"] != peer || line["state"] != "merged") continue;
      const auto& pose = line["pose"];
      return Pose2{pose[0].get<double>(), pose[1].get<double>(), pose[2].get<double>()};
    }
    return std::nullopt;
  }
  std::uint64_t rejected(const std::string& reason) const {
    const auto radio = latest("radio");
    return radio.is_null() ? 0 : radio["rejected"][reason].get<std::uint64_t>();
  }

 private:
  void take_in(const nlohmann::json& line) {
    const std::string type = line["type"];
    latest_[type] = line;
    if (type == "alignment") alignments_[line["peer"]] = line;
    // The line of the radio says how many peers' lines follow.
    if (type == "radio") {
      coming_.clear();
      peers_left_ = line["peers"];
      if (peers_left_ == 0) peers_.clear();
    }
    if (type == "peer") {
      coming_[line["name"]] = line;
      if (--peers_left_ == 0) peers_ = coming_;
    }
  }

  const std::string name_;
  const std::string netns_;
  const std::string base_;
  std::unique_ptr<Process> process_;
  std::unique_ptr<LineReader> reader_;
  std::map<std::string, nlohmann::json> latest_;
  std::map<int, nlohmann::json> alignments_;
  std::map<std::string, nlohmann::json> peers_;   // all of one telling
  std::map<std::string, nlohmann::json> coming_;  // of the telling that goes on
  int peers_left_ = 0;                            // of it
};

using Daemons = std::vector<SimDaemon*>;

// Listens to all until `holds`; false after `limit_s`.
template <typename Holds>
bool listen_until(const Daemons& daemons, double limit_s, Holds holds) {
  const Time limit = monotonic_now() + Duration::from_seconds(limit_s);
  while (!holds()) {
    if (monotonic_now() > limit) return false;
    bool heard = false;
    for (SimDaemon* daemon : daemons) heard = daemon->listen() || heard;
    if (!heard) sleep_until(monotonic_now() + Duration{5'000'000});
  }
  return true;
}

}  // namespace zenith
