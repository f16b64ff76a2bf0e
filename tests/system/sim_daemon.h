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

class SimDaemon {
 public:
  // `radio`: lines of the section [radio]. `netns`: where it runs; empty: here.
  SimDaemon(const std::filesystem::path& folder, const std::string& robot, const std::string& radio,
            const std::string& netns = "")
      : name_(robot), netns_(netns), base_((folder / robot).string()) {
    tools::write_text(
        base_ + ".toml",
        "[robot]\nname = \"" + robot + "\"\n[camera]\ndriver = \"simulated\"\n[odometry]\n" +
            "driver = \"simulated\"\n[telemetry]\nrate_hz = 2\nsocket = \"" + base_ +
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
    std::vector<std::string> words = {ZENITHD_SIM, "--config", base_ + ".toml"};
    if (!netns_.empty()) {
      const std::vector<std::string> prefix = {"/usr/bin/env", "ip", "netns", "exec", netns_};
      words.insert(words.begin(), prefix.begin(), prefix.end());
    }
    process_ = std::make_unique<Process>(words, base_ + ".out", base_ + ".log");
    return wait_until(60.0, [&] {
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
    return process_->wait(30.0);
  }
  void kill() {
    process_->send(SIGKILL);
    (void)process_->wait(30.0);
  }

  // Takes in the next line.
  void listen() {
    const auto line = nlohmann::json::parse(reader_->next(), nullptr, false);
    if (!line.is_object()) return;
    const std::string type = line["type"];
    latest_[type] = line;
    if (type == "alignment") alignments_[line["peer"]] = line;
    if (type == "peer") peers_[line["name"]] = {line, monotonic_now()};
  }

  const std::string& name() const { return name_; }
  std::string log() const { return tools::read_text(base_ + ".log"); }
  bool logged(const std::string& text) const { return log().find(text) != std::string::npos; }
  // The latest line of a type; null before the first.
  nlohmann::json latest(const std::string& type) const {
    const auto found = latest_.find(type);
    return found == latest_.end() ? nlohmann::json() : found->second;
  }
  // What it knows of a robot that it exchanges maps with; null when it is none (any more).
  nlohmann::json peer(const std::string& name) const {
    const auto found = peers_.find(name);
    const bool is_fresh =
        found != peers_.end() && monotonic_now() - found->second.second < Duration{4'000'000'000};
    return is_fresh ? found->second.first : nlohmann::json();
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
  const std::string name_;
  const std::string netns_;
  const std::string base_;
  std::unique_ptr<Process> process_;
  std::unique_ptr<LineReader> reader_;
  std::map<std::string, nlohmann::json> latest_;
  std::map<int, nlohmann::json> alignments_;
  std::map<std::string, std::pair<nlohmann::json, Time>> peers_;
};

using Daemons = std::vector<SimDaemon*>;

// Listens to all until `holds`; false after `limit_s`.
template <typename Holds>
bool listen_until(const Daemons& daemons, double limit_s, Holds holds) {
  const Time limit = monotonic_now() + Duration::from_seconds(limit_s);
  while (!holds()) {
    if (monotonic_now() > limit) return false;
    for (SimDaemon* daemon : daemons) daemon->listen();
  }
  return true;
}

}  // namespace zenith
