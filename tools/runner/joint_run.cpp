#include "tools/runner/joint_run.h"

#include <algorithm>
#include <chrono>

#include "slam/joint_slam.h"

namespace zenith::tools {
namespace {

class JointRun {
 public:
  JointRun(Team& team, const Parameters& parameters)
      : team_(team),
        memory_(JointSlam::memory_needed(parameters)),
        joint_(parameters, memory_.span()) {
    for (auto& member : team_) joint_.add(member->slam());
  }

  // The robots of the next time step; none at the end.
  std::vector<int> next_step() const {
    std::vector<int> robots;
    const int oldest = next_to_step(team_);
    if (oldest < 0) return robots;
    for (int i = 0; i < size(); ++i) {
      if (!team_[i]->has_frame()) continue;
      const double later_s = (team_[i]->stamp() - team_[oldest]->stamp()).seconds();
      if (later_s <= 0.5 * team_[oldest]->frame_period_s()) robots.push_back(i);
    }
    return robots;
  }

  void step(const std::vector<int>& robots) {
    std::vector<JointSlam::Frame> frames;
    for (const int i : robots) frames.push_back({i, team_[i]->input()});
    const auto before = std::chrono::steady_clock::now();
    joint_.step(frames);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    for (const int i : robots) {
      team_[i]->log_step(took.count() / static_cast<double>(robots.size()));
    }
  }

  void share(const std::vector<int>& robots) {
    for (const int from : robots) {
      if (!leads(from)) continue;
      std::vector<int> to;
      for (int i = 0; i < size(); ++i) {
        if (i != from && leads(i)) to.push_back(i);
      }
      tell_peers(team_, from, to, MapSharing::kExact);
    }
  }

  // Robots that the last step has merged with another one take it into their filter.
  void join(const std::vector<int>& robots) {
    for (const int host : robots) {
      bool joined = leads(host);
      while (joined) {
        joined = false;
        for (const Alignment& a : team_[host]->slam().alignments()) {
          const int guest = peer_of_slot(host, a.peer);
          if (a.state != AlignmentState::kMerged || guest == host || !leads(guest)) continue;
          joined = join_one(host, guest, a);
          if (joined) break;
        }
      }
    }
  }

  JointLog finish() {
    log_.counters = joint_.counters();
    return std::move(log_);
  }

 private:
  int size() const { return static_cast<int>(team_.size()); }
  bool leads(int robot) const { return joint_.leader(robot) == robot; }

  bool join_one(int host, int guest, const Alignment& a) {
    const JointCounters before = joint_.counters();
    const auto pairs = team_[host]->slam().correspondences(a.peer);
    if (!joint_.join(host, guest, a.T_own_peer, pairs)) return false;
    const JointCounters& now = joint_.counters();
    log_.joins.push_back({host, guest, team_[host]->stamp(), a.T_own_peer,
                          static_cast<int>(now.common_landmarks - before.common_landmarks),
                          static_cast<int>(now.imported_landmarks - before.imported_landmarks)});
    for (int own = 0; own < size(); ++own) {
      if (joint_.leader(own) == host) tell_partners(own, a);
    }
    return true;
  }

  void tell_partners(int own, const Alignment& a) {
    const Pose2& T = joint_.T_leader_start(own);
    std::vector<PeerLog> partners;
    for (int peer = 0; peer < size(); ++peer) {
      if (peer == own || joint_.leader(peer) != joint_.leader(own)) continue;
      partners.push_back({peer, AlignmentState::kMerged, T.inverse() * joint_.T_leader_start(peer),
                          a.covariance.diagonal(), a.confidence, a.correspondences});
    }
    team_[own]->share_filter(T, std::move(partners));
  }

  Team& team_;
  MemoryBlock memory_;
  JointSlam joint_;
  JointLog log_;
};

}  // namespace

Result<JointLog> run_joint(Team& team, const RunOptions& options, int total,
                           const RunProgress& progress) {
  JointRun run(team, options.parameters);
  int done = 0;
  for (auto robots = run.next_step(); !robots.empty(); robots = run.next_step()) {
    run.step(robots);
    run.share(robots);
    run.join(robots);
    for (const int i : robots) {
      if (options.after_step) options.after_step(static_cast<std::size_t>(i), *team[i]);
      if (const auto more = team[i]->advance(); !more.ok()) return more.error();
      if (progress) progress(++done, total);
    }
  }
  return run.finish();
}

}  // namespace zenith::tools
