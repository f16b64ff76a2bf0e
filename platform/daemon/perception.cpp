#include "platform/daemon/perception.h"

#include <algorithm>
#include <span>

#include "platform/linux/clock.h"

namespace zenith {
namespace {

// How often others hear how it goes when no frame comes.
constexpr Duration kReportPeriod = {100'000'000};
// Records of peers that one frame takes.
constexpr int kMaxPeerRecords = 256;

// The step's own limit follows load and reload frame by frame; memory is for the most.
Parameters with_all_corners(Parameters parameters) {
  parameters.corners_max = kMaxCorners;
  return parameters;
}

PageFaults operator-(const PageFaults& a, const PageFaults& b) {
  return {a.minor - b.minor, a.major - b.major};
}

PeerReport report_of(const Alignment& a) {
  return {a.peer,       a.state,
          a.T_own_peer, {a.covariance(0, 0), a.covariance(1, 1), a.covariance(2, 2)},
          a.confidence, a.correspondences};
}

}  // namespace

Perception::Perception(Devices& devices, const Parameters& parameters, std::uint64_t seed,
                       const LiveSettings& live, Exchange& exchange, tap::Tap* tap)
    : devices_(devices),
      exchange_(exchange),
      tap_(tap),
      decoder_(devices.decoder),
      period_(Duration::from_seconds(1.0 / devices.robot.frame_rate_hz)),
      live_(live),
      memory_(Slam::memory_needed(with_all_corners(parameters))) {
  slam_.emplace(devices.robot, with_all_corners(parameters), seed, memory_.span());
  shedder_.set(live.load);
}

void Perception::set_live(const LiveSettings& live) {
  new_live_.back() = live;
  new_live_.publish();
}

void Perception::run(const std::atomic<bool>& stop) {
  faults_at_start_ = thread_page_faults();
  while (!stop.load(std::memory_order_relaxed)) turn_once();
}

void Perception::turn_once() {
  heartbeat_.store(heartbeat_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  take_live();
  receive_can({0});
  if (!frame_) {
    wait_for_frame();
  } else if (wheels_are_there(monotonic_now())) {
    use_frame();
  } else {
    wait_for_wheels();
  }
  const Time now = monotonic_now();
  if (now >= next_report_) write_report(now);
}

void Perception::take_live() {
  if (!new_live_.fetch()) return;
  live_ = new_live_.front();
  shedder_.set(live_.load);
}

void Perception::wait_for_frame() {
  const Time before = monotonic_now();
  if (!camera_turn_.is_perceptions()) {
    if (can_turn_.is_perceptions()) {
      receive_can(kSlice);
    } else {
      sleep_until(before + kSlice);
    }
    return;
  }
  if (!camera_is_known_) period_.begin(devices_.camera->period());
  camera_is_known_ = true;
  CameraFrame frame;
  const CameraWait result = devices_.camera->wait(kSlice, frame);
  const Time now = monotonic_now();
  report_.camera_up = result != CameraWait::kLost;
  switch (result) {
    case CameraWait::kTimeout:
      deadlines_.wake_up.add(now - (before + kSlice));
      return;
    case CameraWait::kLost:
      return lose_camera(devices_.camera->lost_reason());
    case CameraWait::kFrame:
      break;
  }
  period_.note(frame.stamp, frame.sequence);
  const Lens& lens = devices_.robot.lens;
  if (frame.luma.width != lens.width_px || frame.luma.height != lens.height_px) {
    report_.last_frame = now;
    ++report_.frames_unfit;
    return;
  }
  frame_ = frame;
  received_ = now;
  if (tap_ != nullptr) tap_->add(frame);
}

bool Perception::wheels_are_there(Time now) const {
  return (!wheels_.empty() && wheels_[wheels_.size() - 1].stamp >= frame_->stamp) ||
         !can_turn_.is_perceptions() || now >= received_ + live_.patience;
}

void Perception::wait_for_wheels() {
  const Duration left = received_ + live_.patience - monotonic_now();
  receive_can(std::min(left, kSlice));
}

std::size_t Perception::receive_can(Duration timeout) {
  if (!can_turn_.is_perceptions()) return 0;
  std::size_t total = 0;
  // A bus that brings more than this in one go may wait for the next turn.
  constexpr int kMaxBatches = 8;
  for (int batch = 0; batch < kMaxBatches; ++batch) {
    const std::size_t count =
        devices_.can->receive(batch == 0 ? timeout : Duration{0}, can_frames_);
    const Time now = monotonic_now();
    for (std::size_t i = 0; i < count; ++i) {
      if (tap_ != nullptr) tap_->add(can_frames_[i]);
      if (const auto sample = decoder_.decode(can_frames_[i])) keep(*sample, now);
    }
    total += count;
    if (count < can_frames_.size()) break;
  }
  note_can_state();
  return total;
}

void Perception::keep(const WheelSample& sample, Time now) {
  report_.last_wheels = now;
  frozen_.note_wheels(sample);
  if (wheels_.full()) {
    // No frame for long. The newest one stays: it tells whether a frame has its wheels.
    slam_->add_wheels(wheels_.span().first(wheels_.size() - 1));
    wheels_[0] = wheels_[wheels_.size() - 1];
    wheels_.shrink_to(1);
  }
  wheels_.push_back(sample);
}

void Perception::note_can_state() {
  const CanState state = devices_.can->state();
  const bool was_off = report_.bus_off;
  report_.bus_off = state == CanState::kBusOff;
  report_.can_up = state == CanState::kUp;
  if (report_.bus_off && !was_off) tell(PerceptionEventKind::kBusOff);
  if (was_off && state == CanState::kUp) tell(PerceptionEventKind::kBusBack);
  if (state != CanState::kDown && state != CanState::kClosed) return;
  tell(PerceptionEventKind::kCanLost, devices_.can->lost_reason());
  report_.can = devices_.can->counters();
  can_turn_.give_to_keeper();
}

void Perception::lose_camera(const char* why) {
  tell(PerceptionEventKind::kCameraLost, why);
  report_.camera = devices_.camera->counters();
  camera_is_known_ = false;
  camera_turn_.give_to_keeper();
}

// Whether the frame shows what was seen elsewhere: it is not used then. Its wheels stay for the
// next one.
bool Perception::pass_over_old_picture() {
  const FrozenPicture::Verdict verdict = frozen_.judge(frame_->luma);
  const bool was_frozen = report_.camera_frozen;
  report_.camera_frozen = verdict == FrozenPicture::Verdict::kFrozen;
  if (report_.camera_frozen && !was_frozen) tell(PerceptionEventKind::kPictureFrozen);
  if (was_frozen && !report_.camera_frozen) tell(PerceptionEventKind::kPictureMoves);
  if (verdict != FrozenPicture::Verdict::kStale && !report_.camera_frozen) {
    report_.last_frame = received_;
    return false;
  }
  ++report_.frames_frozen;
  frame_.reset();
  const Time now = monotonic_now();
  if (report_.camera_frozen && now >= next_reopening_) {
    next_reopening_ = now + kReopenFrozen;
    lose_camera("its picture is frozen");
  }
  return true;
}

void Perception::use_frame() {
  if (pass_over_old_picture()) return;
  const Time start = monotonic_now();
  const Duration cpu_start = thread_cpu_time();
  if (wheels_.empty() || wheels_[wheels_.size() - 1].stamp < frame_->stamp) ++report_.wheels_late;
  StepInput input;
  input.stamp = frame_->stamp;
  input.frame = frame_->luma;
  input.wheels = wheels_.span();
  input.corners_max = shedder_.corners_max();
  const StepOutput& output = slam_->step(input);
  frame_.reset();
  wheels_.clear();
  receive_peers();
  publish();
  if (picture_asked_.load(std::memory_order_relaxed)) leave_picture();

  const bool first = !report_.has_pose;
  if (output.accepted) note_step(report_, output);
  note_alignments();
  note_repairs();
  note_verdict();

  if (tap_ != nullptr && output.accepted)
    tap_->add(tap::TappedPose{output.stamp, output.T_start_robot});

  const Time end = monotonic_now();
  const Duration cpu = {thread_cpu_time().ns - cpu_start.ns};
  deadlines_.note(end - start, cpu, end - output.stamp, period_.value());
  report_.step = end - start;
  report_.period = period_.value();
  note_load(end - start);
  if (first && report_.has_pose) tell(PerceptionEventKind::kFirstPose);
  write_report(end);
}

void Perception::receive_peers() {
  if (past_left_.load(std::memory_order_relaxed)) {
    past_left_.store(false, std::memory_order_relaxed);
    slam_->forget(kPastSlot);
  }
  // Slam takes records of one peer at a time: runs of one peer's go together.
  std::size_t count = 0;
  int peer = 0;
  const auto hand_over = [&] {
    if (count > 0) slam_->receive(peer, std::span(records_).first(count));
    count = 0;
  };
  PeerNews next;
  for (int i = 0; i < kMaxPeerRecords && exchange_.peers.pop(next); ++i) {
    if (next.peer < 0 || next.peer >= kMaxPeers) continue;
    const bool forget = next.kind == PeerNews::Kind::kForget;
    if (forget || next.peer != peer || count == records_.size()) hand_over();
    peer = next.peer;
    if (forget) {
      slam_->forget(peer);
    } else {
      records_[count++] = next.record;
    }
  }
  hand_over();
  MergeNews merge;
  while (exchange_.merges_with_us.pop(merge)) {
    if (merge.peer >= 0 && merge.peer < kMaxPeers) {
      slam_->offer_alignment(merge.peer, merge.T_own_peer);
    }
  }
}

void Perception::publish() {
  // What finds no place is not asked for: it stays in the map, and comes with a later frame.
  const std::size_t room = Exchange::kRecords - exchange_.own.size();
  const std::size_t count =
      slam_->publish(std::span(records_).first(std::min(room, records_.size())));
  for (std::size_t i = 0; i < count; ++i) exchange_.own.push(records_[i]);
}

void Perception::leave_picture() {
  picture_asked_.store(false, std::memory_order_relaxed);
  slam_->look(pictures_.back());
  pictures_.publish();
}

void Perception::note_alignments() {
  const auto merged_before = [this](int peer) {
    for (const PeerReport& old : report_.peers) {
      if (old.peer == peer) return old.state == AlignmentState::kMerged;
    }
    return false;
  };
  FixedVector<PeerReport, kMaxPeers> peers;
  for (const Alignment& alignment : slam_->alignments()) {
    const bool before = merged_before(alignment.peer);
    const bool merged = alignment.state == AlignmentState::kMerged;
    if (merged && !before) tell(PerceptionEventKind::kMerged, "", alignment.peer);
    if (before && !merged) tell(PerceptionEventKind::kWithdrawn, "", alignment.peer);
    peers.push_back(report_of(alignment));
  }
  report_.peers = peers;
  OwnState state;
  state.has_pose = true;
  state.T_start_robot = report_.T_start_robot;
  for (const PeerReport& peer : peers) {
    if (peer.peer < kPeerSlots) state.peers.push_back(peer);
  }
  exchange_.own_state.write(state);
}

// Since the last report: what the counters say of the filter's numbers.
void Perception::note_repairs() {
  const RepairCounters before = report_.steps.mapper.repairs;
  const RepairCounters after = slam_->counters().mapper.repairs;
  for (const RepairKind& kind : kRepairKinds) {
    if (after.*kind.count == before.*kind.count) continue;
    report_.repaired = true;
    report_.last_repair = monotonic_now();
    return tell(PerceptionEventKind::kRepaired, kind.name.data(), 0,
                static_cast<int>(after.total()));
  }
}

// Reasons that came and went with this frame.
void Perception::note_verdict() {
  const SetupVerdict before = report_.verdict;
  const SetupVerdict& after = slam_->verdict();
  const auto tell_new = [this](const SetupVerdict& from, const SetupVerdict& to,
                               PerceptionEventKind kind) {
    for (const Reason& reason : to.reasons) {
      if (reason.code != SetupCode::kNotJudgedYet && !gives(from, reason.code)) tell(kind, reason);
    }
  };
  tell_new(before, after, PerceptionEventKind::kReasonGiven);
  tell_new(after, before, PerceptionEventKind::kReasonWithdrawn);
  report_.verdict = after;
}

void Perception::note_load(Duration wall) {
  const bool shed_before = shedder_.sheds();
  shedder_.note(wall, period_.value());
  report_.sheds = shedder_.sheds();
  report_.corners_max = shedder_.corners_max();
  report_.frames_shed = shedder_.frames_shed();
  if (report_.sheds == shed_before) return;
  tell(report_.sheds ? PerceptionEventKind::kShedding : PerceptionEventKind::kShedNoMore, "", 0,
       shedder_.corners_max());
}

void Perception::write_report(Time now) {
  next_report_ = now + kReportPeriod;
  report_.written = now;
  if (camera_turn_.is_perceptions()) report_.camera = devices_.camera->counters();
  if (can_turn_.is_perceptions()) report_.can = devices_.can->counters();
  report_.camera_up = report_.camera_up && camera_turn_.is_perceptions();
  report_.can_up = report_.can_up && can_turn_.is_perceptions();
  report_.agreed_period = period_.agreed();
  report_.measured_period = period_.measured();
  report_.wheels = decoder_.counters();
  report_.wheel_fault = decoder_.fault();
  report_.steps = slam_->counters();
  report_.corners_max = shedder_.corners_max();
  report_.faults = thread_page_faults() - faults_at_start_;
  reports_.write(report_);
}

void Perception::tell(PerceptionEventKind kind, const Reason& reason) {
  PerceptionEvent event;
  event.kind = kind;
  event.text = setup_code_name(reason.code).data();
  event.at = monotonic_now();
  event.pose = report_.T_start_robot;
  event.reason = reason;
  events_.push(event);  // full: counted by the queue
}

void Perception::tell(PerceptionEventKind kind, const char* text, int peer, int value) {
  PerceptionEvent event;
  event.kind = kind;
  event.text = text;
  event.peer = peer;
  event.value = value;
  event.at = monotonic_now();
  event.pose = report_.T_start_robot;
  for (const Alignment& alignment : slam_->alignments()) {
    if (kind == PerceptionEventKind::kMerged && alignment.peer == peer) {
      event.pose = alignment.T_own_peer;
    }
  }
  events_.push(event);  // full: counted by the queue
}

}  // namespace zenith
