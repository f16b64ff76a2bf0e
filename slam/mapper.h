#pragma once
// One robot's own SLAM: particles and map from wheels and features (paper II). Knows no peers.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "platform/base/arena.h"
#include "platform/base/random.h"
#include "slam/closing.h"
#include "slam/counters.h"
#include "slam/features.h"
#include "slam/filter/calibration.h"
#include "slam/filter/depth_prior.h"
#include "slam/filter/drift.h"
#include "slam/filter/motion.h"
#include "slam/filter/noise_scale.h"
#include "slam/filter/particles.h"
#include "slam/filter/proposal.h"
#include "slam/filter/scale_watch.h"
#include "slam/map/association.h"
#include "slam/map/map.h"
#include "slam/parameters.h"
#include "slam/recovery/pose_search.h"
#include "slam/recovery/relocaliser.h"
#include "slam/recovery/tracking.h"
#include "slam/robot.h"

namespace zenith {

class Mapper {
 public:
  Mapper() = default;
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  void layout(Arena& arena, const Parameters& parameters);
  void build(const RobotConfig& robot, const Parameters& parameters, std::uint64_t seed);

  // Whether the robot moved enough since the last used frame for this one to tell anything new.
  bool worth_using(const MotionIncrement& moved) const;

  // Whether the picture has moved though the wheels have not: the robot is pushed or turned.
  bool sees_push(const Features& features) const;

  // One used frame; `moved`: by the wheels since the last used one.
  // Corrects the features for the calibration learned so far.
  //
  // A frame that does not fit where the wheels lead, nor any place near, is held: the poses follow
  // the wheels, the map stays as it is.
  //
  // A frame that shows fewer than kLeastSeen landmarks of the map is blind: poses are moved by the
  // wheels' mean, and their error is not drawn. It is kept, composed with that of further blind
  // frames, and drawn at once when landmarks are seen again, with all that they say of it; or when
  // new ones are started. In between the mean pose is that of the wheels.
  void update(const MotionIncrement& moved, Features& features, const FeatureExtractor& view);

  // What breaks in it is repaired and counted (MapperCounters::repairs): see mapper_repair.cpp.
  // The phases of update() in their order, for a filter over several robots (joint.h).
  // By odometry; corrects the features.
  void move(const MotionIncrement& moved, Features& features);
  // Tentative landmarks that are out of sight for long.
  void forget_unseen();
  // Matches the features, draws the poses, adds to the log weights.
  void sense(const Features& features, const FeatureExtractor& view);
  // Normalises the weights; the mean pose.
  void estimate();
  // After the update of a matched landmark's rows.
  void note(const Candidate& c, const Feature& f);
  // Promotion and pruning of this frame's candidates.
  void keep();
  // New landmarks, when the robot has gone on far enough since the last ones.
  bool start_due(const Features& features) const;
  void start_landmarks(const Features& features);
  // Poses, weights, map. The parents are valid until the next call.
  bool resampling_due() const;
  std::span<const std::uint16_t> resample();
  // The poses alone, after the resampling of a mapper that this one has joined.
  void follow(std::span<const std::uint16_t> parents);

  // Particle i becomes one with the host's particle i, at T_host_own[i] times its pose: one weight,
  // one ancestry and one map for both from now on, the host's. Calibrations stay as learned.
  void join(Mapper& host, std::span<const Pose2> T_host_own);
  void freeze_calibration();
  // The part of this robot's way that ages the map: 1 / robots that share it.
  void set_way_share(double share) { way_share_ = share; }
  Random& random() { return random_; }

  const Particles& particles() const { return particles_; }
  const PoseEstimate& pose() const { return pose_; }
  const Map& map() const { return *map_; }
  Map& map() { return *map_; }
  // This frame's predicted landmarks with their matches.
  std::span<const Candidate> candidates() const { return candidates_[0].span(); }
  double travelled_m() const { return travelled_m_; }
  double effective_sample_size() const { return effective_; }
  const CalibrationEstimator& calibration() const { return calibration_; }
  // Over (x, y, theta), in the map's frame: the particles' spread with what they do not know.
  Eigen::Matrix3d pose_covariance() const;
  // Of a landmark's place, likewise.
  Eigen::Matrix3d landmark_covariance(const LandmarkInfo& landmark) const;
  // The noise with which corners count: the stated one, or what was learned beyond.
  double corner_sigma_px() const { return noise_scale_.sigma_factor() * p_.pixel_sigma_px; }
  bool loop_closing() const { return loop_closing_; }
  // After the last frame of update().
  TrackingState tracking() const { return tracking_.state(); }
  // The last used frame showed too little of the map: the pose is the wheels' since the last other.
  bool blind() const { return blind_; }
  const MapperCounters& counters() const { return counters_; }
  Eigen::Vector2d lever_m() const { return {robot_.mount.x_m, robot_.mount.y_m}; }
  const RobotConfig& robot() const { return robot_; }
  MotionNoise motion_noise() const;

 private:
  // A corner is found to so many pixels of the frame, and rectified pixels grow outwards.
  float observation_noise(float r2) const {
    return growth_.grown(static_cast<float>(noise_scale_.kappa()) * noise_, r2);
  }

  static constexpr int kLeastSeen = 3;
  static constexpr double kDegree = std::numbers::pi / 180.0;

  void predict_candidates(const FeatureExtractor& view);
  bool predict_candidate(int slot, const FeatureExtractor& view, Candidate& out);
  void relate_to_pose();
  void note_shared(const LandmarkRows& rows, Candidate& c) const;
  void match_tentative(const Features& features);
  void associate(const Features& features, const FeatureExtractor& view);
  bool close_loop(const Features& features, const FeatureExtractor& view,
                  const Eigen::Matrix3d& prior);
  Eigen::Matrix3d expected_jump(const Eigen::Matrix3d& prior) const;
  bool owns_map() const { return map_ == &own_map_ && way_share_ == 1.0; }
  void tell_closings(const CalibrationVector& step);
  void tie_to_old_map(const ClosingFrame& frame, const Eigen::Vector3d& jump);
  bool give_way(const Eigen::Vector3d& jump);
  void use_old_matches();
  void follow_old_map();
  void note_drift();
  void jump_particles();
  void carry_recent_map();
  void glide();
  void fetch_old_map();
  void refresh_moved(std::span<const std::int32_t> slots);
  Map::Piece recent_piece() const;
  Map::Piece old_piece() const;
  bool knows_scale() const;
  void believe_slip();
  void begin_anew();
  void refresh_in_turn();
  void locate_matches(CandidateKind kind, const Features& features);
  void trust_matches(const Features& features);
  void learn_noise(const Features& features);
  void carry_drift();
  void learn_calibration(const Features& features);
  void move_by_calibration(const CalibrationVector& step);
  void match(const Features& features, const FeatureExtractor& view);
  void weigh(const Features& features);
  // mapper_recovery.cpp:
  // Matches; false: the frame does not fit.
  bool follow(const Features& features, const FeatureExtractor& view);
  bool recover(const FrameOverMap& frame);
  bool relocalise(const FrameOverMap& frame);
  bool continue_at(const FrameOverMap& frame, const Pose2& T_own_robot);
  void note_as_seen(const Pose2& T_own_robot);
  void shift_poses(const Pose2& by);
  void hold();
  MatchShare match_share() const;
  void keep_corners(const Features& features);

  // mapper_repair.cpp, each after what may have broken something:
  void set_motion(const MotionIncrement& moved);
  void check_poses();
  void reset_poses();
  void check_correction();
  void check_estimate();
  void finish_calibration();
  void restart_calibration();
  void drop_landmark(int slot);
  bool refresh_place(int slot);  // false: the landmark had to be dropped
  void check_map();
  void weigh_and_move(const Features& features);
  void add_proposals(const Features& features);
  void add_likelihoods(const Features& features);
  int heaviest_particle() const;
  static bool shows_corners(const Features& features);
  bool sees_map() const;
  void wait_for_landmarks();
  bool near_candidate(const Feature& f) const;
  void evict_one();
  void evict_anchor();
  Eigen::Matrix3d spread_in_body() const;

  RobotConfig robot_;
  Parameters p_;
  AssociationSettings association_;
  Random random_{0};
  double pixel_ = 0.0;  // of the level image, in tangents
  PixelGrowth growth_;
  float noise_ = 0.0F;  // variance of an observation at the image's centre, tangents squared
  DepthPrior depth_prior_;
  Particles particles_;
  int heaviest_ = 0;  // particle, as of the last prediction
  PoseEstimate pose_;
  Map own_map_;
  Map* map_ = &own_map_;  // or the map of the mapper that this one has joined
  Associator associator_;
  Pose2 moved_;              // by the wheels: this frame's mean
  MotionIncrement motion_;   // the same after what was undrawn before
  MotionIncrement undrawn_;  // by which the particles were moved, its error not yet drawn
  bool blind_ = false;       // the last used frame
  ProposalRows proposal_;
  CalibrationEstimator calibration_;
  NoiseScale noise_scale_;
  DriftEstimate drift_;
  MapErrors map_errors_;
  PoseSensitivity pose_by_calibration_ = PoseSensitivity::Zero();
  std::span<Candidates> candidates_;
  std::span<std::uint16_t> parents_;
  std::span<double> resample_scratch_;
  std::array<bool, kMaxCorners> corner_used_ = {};
  PoseCorrection correction_;
  bool loop_closing_ = false;
  ClosingSearch closing_search_;
  Closing closing_;
  bool jumped_ = false;   // in this frame the pose follows the old landmarks alone
  bool gliding_ = false;  // in this frame the pose goes a part of a jump
  Pose2 glide_;
  double drift_travel_m_ = 0.0;  // as Map::drift_travel_m(), of the robot
  std::span<Pose2> before_;      // by particle: the pose by the recent landmarks; then its jump
  ScaleWatch scale_;
  Tracking tracking_;
  PoseSearch search_;
  Relocaliser relocaliser_;
  // Where the last used frame showed landmarks.
  FixedVector<Eigen::Vector2f, kMaxCorners> corners_kept_;
  bool scale_wrong_ = false;
  std::uint64_t frames_used_ = 0;
  int resets_in_row_ = 0;  // used frames in which all poses broke
  bool poses_broke_ = false;
  bool first_ = true;
  double travelled_m_ = 0.0;
  double way_share_ = 1.0;
  int refresh_next_ = 0;
  double anchor_travel_m_ = 0.0;
  double anchor_heading_rad_ = 0.0;
  double effective_ = 0.0;
  MapperCounters counters_;
};

}  // namespace zenith
