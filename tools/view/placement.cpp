#include "tools/view/placement.h"

namespace zenith::tools {
namespace {

struct Edge {
  std::string own;
  std::string peer;
  Pose2 T_own_peer;
};

std::vector<Edge> merges(const std::vector<RobotState>& robots) {
  std::vector<Edge> edges;
  for (const RobotState& robot : robots) {
    for (const auto& [key, line] : robot.lines()) {
      const auto* alignment = line.as<AlignmentLine>();
      if (alignment == nullptr || alignment->state != "merged" || !alignment->pose) continue;
      std::string peer = alignment->name;
      if (peer == kEarlierSession) continue;
      if (peer == kPastSelf) peer = robot.name() + " " + peer;
      const auto& [x, y, theta] = *alignment->pose;
      edges.push_back({robot.name(), std::move(peer), {x, y, theta}});
    }
  }
  return edges;
}

}  // namespace

std::map<std::string, Pose2> place_starts(const std::vector<RobotState>& robots,
                                          std::size_t first) {
  std::map<std::string, Pose2> placed;
  if (first >= robots.size()) return placed;
  placed[robots[first].name()] = {};
  const std::vector<Edge> edges = merges(robots);
  for (bool more = true; more;) {
    more = false;
    for (const Edge& edge : edges) {
      const auto own = placed.find(edge.own);
      const auto peer = placed.find(edge.peer);
      if (own != placed.end() && peer == placed.end()) {
        placed[edge.peer] = own->second * edge.T_own_peer;
        more = true;
      } else if (own == placed.end() && peer != placed.end()) {
        placed[edge.own] = peer->second * edge.T_own_peer.inverse();
        more = true;
      }
    }
  }
  return placed;
}

}  // namespace zenith::tools
