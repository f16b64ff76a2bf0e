#pragma once
// Several robots' Slam in one process, in one filter once they are aligned (paper II-B).
//
// Until its filter is joined with another's, a robot's step is Slam::step(), bit for bit.
// Afterwards its outputs stay in its own start frame, T_leader_start apart from the common map,
// which is in the start frame of its filter's leader: landmarks(), publish() and the alignments of
// the leader speak for all of them. Members that do not lead no longer search peers' maps.
//
// As Slam: pure, fixed memory from the caller, one caller at a time.

#include <cstddef>
#include <span>

#include "slam/joint.h"
#include "slam/slam.h"

namespace zenith {

class JointSlam {
 public:
  static std::size_t memory_needed(const Parameters& parameters);

  // `memory` must outlive this, be aligned to 64 bytes and hold memory_needed() bytes.
  JointSlam(const Parameters& parameters, std::span<std::byte> memory);
  ~JointSlam();
  JointSlam(const JointSlam&) = delete;
  JointSlam& operator=(const JointSlam&) = delete;

  // Robots are numbered as they are added, at most kMaxObservers of them. Before their first step;
  // they must outlive this.
  void add(Slam& slam);

  // One time step: frames of different robots that were taken at about the same time. Each robot's
  // frames must come with rising stamps. The outputs are read from Slam::output().
  struct Frame {
    int robot = -1;
    StepInput input;
  };
  void step(std::span<const Frame> frames);

  // The guest's filter joins the host's, both leaders, by the alignment that the host found and the
  // pairs of landmarks that hold it (own: the host's). False: see JointFilter::join().
  bool join(int host, int guest, const Pose2& T_host_guest, std::span<const Correspondence> pairs);

  int leader(int robot) const;
  const Pose2& T_leader_start(int robot) const;
  const JointCounters& counters() const;

 private:
  struct State;
  State* state_;  // inside the caller's memory
};

}  // namespace zenith
