// Recordings of computers that were started at different times: with clock.csv they are replayed as
// if one clock had stamped them; without, or with wheels of another clock, it is told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/recording/candump.h"
#include "platform/recording/clock_log.h"
#include "platform/recording/frame_list.h"
#include "platform/recording/layout.h"
#include "platform/recording/seconds.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/replay.h"
#include "tools/replay_judgement.h"
#include "tools/simulate.h"

namespace zenith::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kWall = 1'780'000'000 * kSecond;

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::istringstream in(read_text(path));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

void move_frames(const fs::path& recording, Duration by) {
  std::string text;
  for (const std::string& line : lines_of(layout::frame_list(recording))) {
    const std::size_t comma = line.find(',');
    text += line[0] == '#'
                ? line
                : std::to_string(std::stoll(line.substr(0, comma)) + by.ns) + line.substr(comma);
    text += '\n';
  }
  write_text(layout::frame_list(recording), text);
  text.clear();
  for (const std::string& line : lines_of(layout::ground_truth(recording))) {
    const std::size_t space = line.find(' ');
    text += line[0] == '#'
                ? line
                : format_seconds(*parse_seconds(line.substr(0, space)) + by) + line.substr(space);
    text += '\n';
  }
  write_text(layout::ground_truth(recording), text);
}

void move_wheels(const fs::path& recording, Duration by) {
  std::string text;
  for (const std::string& line : lines_of(layout::can_log(recording, "can0"))) {
    CandumpRecord record = parse_candump(line);
    ASSERT_EQ(record.line, CandumpLine::kFrame);
    record.frame.stamp = record.frame.stamp + by;
    text += format_candump(record.frame, record.interface) + '\n';
  }
  write_text(layout::can_log(recording, "can0"), text);
}

class ReplayClocks : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const std::string world = ZENITH_SOURCE_DIR "/tests/system/worlds/one-room.toml";
    const auto names = write_simulation({world, 3, 24.0}, folder_->path() / "rec", {});
    ASSERT_TRUE(names.ok()) << names.error().message;
  }
  static void TearDownTestSuite() { delete folder_; }

  // A copy of r1 and r2 in a folder of its own.
  static ReplayPlan copies(const std::string& where) {
    ReplayPlan plan;
    for (const char* name : {"r1", "r2"}) {
      plan.recordings.push_back(folder_->path() / where / name);
      fs::create_directories(plan.recordings.back().parent_path());
      fs::copy(folder_->path() / "rec" / name, plan.recordings.back(), fs::copy_options::recursive);
    }
    return plan;
  }
  // As the computer that was started `later_s` later stamps it.
  static void restart(const fs::path& recording, double later_s) {
    move_frames(recording, Duration::from_seconds(-later_s));
    move_wheels(recording, Duration::from_seconds(-later_s));
  }
  static ClockReading reading(double monotonic_s, double later_s, double set_s = 0.0) {
    return {{Duration::from_seconds(monotonic_s).ns},
            {},
            {kWall + Duration::from_seconds(later_s + set_s).ns},
            true};
  }
  static void write_clock(const fs::path& recording, const std::vector<ClockReading>& readings) {
    std::string text = kClockLogHeader;
    for (const ClockReading& r : readings) text += format_clock_reading(r);
    write_text(layout::clocks(recording), text);
  }
  static fs::path make(const std::string& name) {
    const fs::path path = folder_->path() / name;
    fs::create_directories(path);
    return path;
  }
  static Result<ReplayResult> run(const ReplayPlan& plan, const fs::path& out) {
    return replay(plan, out, {});
  }
  // What does not depend on the clock is the same, bit for bit.
  static void expect_same_maps(const fs::path& one, const fs::path& two) {
    for (const char* robot : {"r1", "r2"}) {
      EXPECT_EQ(read_text(one / robot / "landmarks.csv"), read_text(two / robot / "landmarks.csv"));
      const auto a = lines_of(one / robot / "alignments.csv");
      const auto b = lines_of(two / robot / "alignments.csv");
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].substr(a[i].find(',')), b[i].substr(b[i].find(',')));
      }
    }
  }

  static TemporaryFolder* folder_;
};

TemporaryFolder* ReplayClocks::folder_ = nullptr;

TEST_F(ReplayClocks, OfTwoComputersMergeAsOnOneClock) {
  const fs::path one = make("one_out");
  const auto unshifted = run(copies("one"), one);
  ASSERT_TRUE(unshifted.ok()) << unshifted.error().message;
  EXPECT_THAT(unshifted->warnings, IsEmpty());
  ASSERT_FALSE(unshifted->figures.pairs.empty());
  EXPECT_TRUE(unshifted->figures.pairs[0].merge_time_s) << "they must meet for this test";

  // r1's computer has run for 5000 s, r2's was started 4998 s later.
  ReplayPlan plan = copies("two");
  restart(plan.recordings[0], -5000.0);
  restart(plan.recordings[1], -2.0);
  write_clock(plan.recordings[0], {reading(5000.0, -5000.0), reading(5024.0, -5000.0)});
  write_clock(plan.recordings[1], {reading(2.0, -2.0), reading(26.0, -2.0)});
  const fs::path two = make("two_out");
  const auto shifted = run(plan, two);
  ASSERT_TRUE(shifted.ok()) << shifted.error().message;
  EXPECT_THAT(shifted->warnings, IsEmpty());
  EXPECT_THAT(shifted->notes, Contains(HasSubstr("s in common")));
  EXPECT_EQ(shifted->figures.pairs[0].merge_time_s, unshifted->figures.pairs[0].merge_time_s);
  expect_same_maps(one, two);

  // Judged from its files, it is found again in its recordings.
  const auto judged = judge_output(two, plan.recordings);
  ASSERT_TRUE(judged.ok()) << judged.error().message;
  EXPECT_NEAR(*judged->robots[1].ate_m, *shifted->figures.robots[1].ate_m, 1e-5);

  // The same when r2's wall clock was wrong by 30 s until NTP came, half way.
  write_clock(plan.recordings[1],
              {{{2 * kSecond}, {}, {kWall - 32 * kSecond}, false}, reading(14.0, -2.0)});
  const fs::path stepped_out = make("stepped_out");
  const auto stepped = run(plan, stepped_out);
  ASSERT_TRUE(stepped.ok()) << stepped.error().message;
  EXPECT_THAT(stepped->warnings, testing::ElementsAre(HasSubstr("set by +30.000 s")));
  expect_same_maps(one, stepped_out);

  // Without clock.csv: the order is another, it is told, and a stated offset mends it.
  for (const fs::path& recording : plan.recordings) fs::remove(layout::clocks(recording));
  const auto apart = run(plan, make("apart_out"));
  ASSERT_TRUE(apart.ok()) << apart.error().message;
  EXPECT_THAT(apart->warnings, Contains(AllOf(HasSubstr("r1 begins 4"), HasSubstr("after the end"),
                                              HasSubstr("--align start"))));
  plan.align.stated_s["r2"] = 4998.0;
  const fs::path stated_out = make("stated_out");
  const auto stated = run(plan, stated_out);
  ASSERT_TRUE(stated.ok()) << stated.error().message;
  EXPECT_THAT(stated->warnings, IsEmpty());
  expect_same_maps(one, stated_out);

  plan.align.stated_s.clear();
  plan.joint = true;
  const auto joint = run(plan, make("joint_out"));
  ASSERT_FALSE(joint.ok());
  EXPECT_THAT(joint.error().message, AllOf(HasSubstr("--joint needs"), HasSubstr("--offset r2=")));
}

TEST_F(ReplayClocks, OneRecordingKeepsItsStamps) {
  ReplayPlan plan = copies("single");
  plan.recordings.resize(1);
  write_clock(plan.recordings[0], {reading(0.0, -700.0)});
  const fs::path out = make("single_out");
  const auto result = run(plan, out);
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_THAT(result->notes, IsEmpty());
  const auto frames = read_frame_list(layout::frame_list(plan.recordings[0]));
  ASSERT_TRUE(frames.ok());
  EXPECT_THAT(lines_of(out / "r1" / "trajectory.tum").at(1),
              testing::StartsWith(format_seconds(frames->front().stamp)));
}

TEST_F(ReplayClocks, ADamagedClockFileIsRefused) {
  ReplayPlan plan = copies("damaged");
  write_text(layout::clocks(plan.recordings[1]), "12,x\n");
  const auto result = run(plan, make("damaged_out"));
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.error().message, HasSubstr("clock.csv:1: expected"));
}

TEST_F(ReplayClocks, WheelsOfAnotherClockAreFoundAndTheOffsetMendsThem) {
  // Wall time beside uptime: nothing in common.
  ReplayPlan plan = copies("other");
  plan.recordings.resize(1);
  move_wheels(plan.recordings[0], {kWall});
  const auto refused = run(plan, make("other_out"));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message,
              AllOf(HasSubstr("no time in common"), HasSubstr("of another clock"),
                    HasSubstr("--wheels-late r1=17")));
  const std::string& told = refused.error().message;
  const std::string number = told.substr(told.rfind('=') + 1);
  EXPECT_NEAR(std::stod(number) - 1'780'000'000.0, 0.0, 0.03) << number;
  plan.wheels_late_s["r1"] = std::stod(number);
  const auto mended = run(plan, make("other_mended"));
  ASSERT_TRUE(mended.ok()) << mended.error().message;
  EXPECT_FALSE(mended->figures.robots[0].verdict->state == VerdictState::kWrong);

  plan.wheels_late_s = {{"nobody", 1.0}};
  EXPECT_FALSE(run(plan, make("nobody")).ok());
}

TEST_F(ReplayClocks, WheelsThatAreSecondsLateAreNamedWithTheOffset) {
  ReplayPlan plan = copies("late");
  plan.recordings.resize(1);
  move_wheels(plan.recordings[0], Duration::from_seconds(3.3));
  const auto result = run(plan, make("late_out"));
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_THAT(result->warnings, Contains(AllOf(HasSubstr("r1: the wheels' stamps are 3."),
                                               HasSubstr("late against the frames'"),
                                               HasSubstr("--wheels-late r1=3.3"))));
  EXPECT_THAT(result->warnings, Contains(HasSubstr("expected 90 %")));
  // Right ones are not accused.
  ReplayPlan right = copies("right");
  right.recordings.resize(1);
  const auto fine = run(right, make("right_out"));
  ASSERT_TRUE(fine.ok());
  EXPECT_THAT(fine->warnings, Not(Contains(HasSubstr("--wheels-late"))));
}

}  // namespace
}  // namespace zenith::tools
