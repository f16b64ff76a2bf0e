#include "platform/daemon/telemetry_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "platform/daemon/telemetry_lines.h"
#include "platform/linux/local_socket.h"
#include "tests/support/line_reader.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using testing::HasSubstr;

class TelemetryTest : public testing::Test {
 protected:
  tools::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "t.sock").string();
};

TEST_F(TelemetryTest, TellsAllReadersLineByLine) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  LineReader first(path_);
  LineReader second(path_);
  EXPECT_EQ(socket.accept("hello\n"), 2u);
  socket.send("one\n");
  socket.send("two\n");
  for (LineReader* reader : {&first, &second}) {
    EXPECT_EQ(reader->next(), "hello\n");
    EXPECT_EQ(reader->next(), "one\n");
    EXPECT_EQ(reader->next(), "two\n");
  }
}

TEST_F(TelemetryTest, AReaderThatDoesNotReadHoldsNobodyUp) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  LineReader sleeper(path_);
  LineReader awake(path_);
  socket.accept("hello\n");
  awake.next();
  const std::string line(1000, 'x');
  for (int i = 0; i < 2000; ++i) {
    socket.send(line);
    ASSERT_EQ(awake.next().size(), line.size()) << i;
  }
  EXPECT_GT(socket.dropped(), 0u);
  EXPECT_EQ(socket.readers(), 2u);
}

// One reader that does not read costs nobody else a line, and gets what it has missed itself.
TEST_F(TelemetryTest, MapsGoOnForTheOthersAndTheSleeperCatchesUp) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  MapLines maps;
  const auto note = [&maps](std::uint32_t id) {
    maps.note({MapNews::kOwn, MapNews::Kind::kLandmark, id, {}, {}, 1});
  };
  const auto send = [&] { socket.send_maps(maps, [](int) { return ""; }); };
  const auto rows = [](const std::string& line) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    return json.is_object() && json.contains("rows") ? json["rows"].size() / 9 : 0u;
  };
  LineReader sleeper(path_);
  LineReader awake(path_);
  ASSERT_EQ(socket.accept("hello\n"), 2u);
  constexpr std::uint32_t kMany = 500;
  for (std::uint32_t id = 1; id <= kMany; ++id) note(id);
  while (socket.dropped() == 0) {  // its room is full of other lines
    socket.send(std::string(1000, 'x') + "\n");
    awake.next();
  }
  std::size_t heard = 0;
  for (int i = 0; i < 200; ++i) {
    send();
    for (std::string line; !(line = awake.next({1000})).empty();) heard += rows(line);
  }
  EXPECT_EQ(heard, kMany) << "each landmark once";
  note(7);
  std::size_t repeated = 0;
  for (int i = 0; i < 200; ++i) {
    send();
    for (std::string line; !(line = awake.next({1000})).empty();) repeated += rows(line);
  }
  EXPECT_EQ(repeated, 1u);

  std::size_t caught_up = 0;
  for (int i = 0; i < 200; ++i) {
    for (std::string line; !(line = sleeper.next({1000})).empty();) caught_up += rows(line);
    send();
  }
  EXPECT_EQ(caught_up, kMany);
  EXPECT_EQ(socket.readers(), 2u);
}

TEST_F(TelemetryTest, AcceptsFewAtOnceHoweverManyCome) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  std::vector<std::unique_ptr<LineReader>> many;
  for (std::size_t i = 0; i < TelemetrySocket::kReaders; ++i) {
    many.push_back(std::make_unique<LineReader>(path_));
  }
  EXPECT_LE(socket.accept("hello\n"), static_cast<std::size_t>(TelemetrySocket::kAcceptsAtOnce));
  EXPECT_GT(socket.accept("hello\n"), 0u) << "the others have their turn";
}

TEST_F(TelemetryTest, OneUserDoesNotTakeAllPlaces) {
  if (::geteuid() != 0) GTEST_SKIP() << "SKIPPED: only root can act as another user";
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  ASSERT_EQ(::chmod(path_.c_str(), 0666), 0);
  constexpr uid_t kOther = 12345;
  std::vector<std::unique_ptr<LineReader>> many;
  for (std::size_t i = 0; i < TelemetrySocket::kReaders; ++i) {
    ASSERT_EQ(::seteuid(kOther), 0);
    many.push_back(std::make_unique<LineReader>(path_));
    ASSERT_EQ(::seteuid(0), 0);
    socket.accept("hello\n");
  }
  EXPECT_EQ(socket.readers(), TelemetrySocket::kReadersOfOne);
  LineReader mine(path_);
  EXPECT_EQ(socket.accept("hello\n"), 1u);
}

TEST_F(TelemetryTest, ForgetsReadersThatLeftAndTurnsAwayTooMany) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  {
    LineReader leaves(path_);
    socket.accept("hello\n");
    EXPECT_EQ(socket.readers(), 1u);
  }
  socket.send("anybody?\n");
  EXPECT_EQ(socket.readers(), 0u);
  std::vector<std::unique_ptr<LineReader>> many;
  for (std::size_t i = 0; i < TelemetrySocket::kReaders + 2; ++i) {
    many.push_back(std::make_unique<LineReader>(path_));
    socket.accept("hello\n");
  }
  EXPECT_EQ(socket.readers(), TelemetrySocket::kReaders);
}

TEST_F(TelemetryTest, ReplacesWhatIsLeftBehindButNotAListener) {
  {
    // Left behind by a program that was killed: the file, and nobody listens.
    const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.data(), path_.size());
    ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    ::close(fd);
  }
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  TelemetrySocket other;
  const Status second = other.open(path_);
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("another program listens"));
  other.close();
  EXPECT_TRUE(std::filesystem::exists(path_)) << "it belongs to the first";
  socket.close();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(TelemetryTest, TellsPicturesToThoseWhoAskedAndForAWhile) {
  TelemetrySocket socket;
  ASSERT_TRUE(socket.open(path_).ok());
  LineReader looks(path_);
  LineReader reads(path_);
  socket.accept("hello\n");
  const Time now{1'000'000'000'000};
  EXPECT_FALSE(socket.take_requests(now));
  looks.say("picture\n");
  reads.say("something else");
  EXPECT_TRUE(socket.take_requests(now));
  EXPECT_FALSE(socket.take_requests(now + TelemetrySocket::kLookLasts));
  looks.say("picture");
  EXPECT_TRUE(socket.take_requests(now));
  LineReader late(path_);
  socket.accept("hello\n");
  socket.send_to_lookers("a picture\n", now);
  socket.send("a line\n");
  for (LineReader* reader : {&looks, &late}) EXPECT_EQ(reader->next(), "hello\n");
  EXPECT_EQ(looks.next(), "a picture\n");
  EXPECT_EQ(late.next(), "a line\n");
}

TEST_F(TelemetryTest, SaysWhyItCannotOpen) {
  TelemetrySocket socket;
  const Status missing = socket.open("/no/such/folder/t.sock");
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, HasSubstr("RuntimeDirectory="));
  EXPECT_FALSE(socket.open(std::string(200, 'x')).ok());
}

TEST(RuntimePath, IsTheServicesFolder) {
  setenv("RUNTIME_DIRECTORY", "/run/zenith:/run/other", 1);
  EXPECT_EQ(runtime_path("t.sock").value(), "/run/zenith/t.sock");
  EXPECT_EQ(runtime_path("/abs/t.sock").value(), "/abs/t.sock");
  unsetenv("RUNTIME_DIRECTORY");
}

TEST(JsonLine, IsJsonWhateverIsPutIn) {
  JsonLine line;
  line.text("a", "quote \" slash \\ line\nend").number("b", 0.5).count("c", 18446744073709551615U);
  line.number("d", std::nan("")).number("e", std::numeric_limits<double>::infinity());
  line.begin("f").flag("g", true).end().numbers("h", std::array<double, 2>{1.0, -2.5});
  EXPECT_EQ(line.finish(),
            "{\"a\":\"quote \\\" slash \\\\ line end\",\"b\":0.5,\"c\":18446744073709551615,"
            "\"d\":null,\"e\":null,\"f\":{\"g\":true},\"h\":[1,-2.5]}\n");
}

TEST(JsonLine, IsEmptyWhenItDoesNotFit) {
  JsonLine line;
  line.text("long", std::string(5000, 'x'));
  EXPECT_EQ(line.finish(), "");
}

TEST(TelemetryLines, APoseTellsTheWheelsAndAClockWhatToAdd) {
  StepOutput step;
  step.stamp = {7};
  step.T_start_robot = {1, 2, 0.5};
  step.pose_covariance << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  step.odometry.T_odom_robot = {3, 4, -0.5};
  step.odometry.covariance = 10 * step.pose_covariance;
  step.odometry.velocity = {0.25, 0, 0.125};
  step.odometry.velocity_covariance = 100 * step.pose_covariance;
  PerceptionReport report;
  note_step(report, step);
  EXPECT_TRUE(report.has_pose);
  JsonLine line;
  write_pose(line, report);
  write_clock(line, {1'767'225'600'123'456'789});
  const std::string said(line.finish());
  EXPECT_THAT(said, HasSubstr(R"("stamp_ns":7,"pose":[1,2,0.5],"covariance":[1,2,3,4,5,6])"));
  EXPECT_THAT(said, HasSubstr(R"("odometry":{"pose":[3,4,-0.5],"covariance":[10,20,30,40,50,60],)"
                              R"("velocity":[0.25,0,0.125],)"
                              R"("velocity_covariance":[100,200,300,400,500,600]})"));
  EXPECT_THAT(said, HasSubstr(R"("system_offset_ns":1767225600123456789)"));
}

// All that the core refuses or repairs is told, each kind by its name.
TEST(TelemetryLines, HealthTellsWhatWasRefusedAndRepaired) {
  PerceptionReport report;
  report.steps.frames_refused = 3;
  report.steps.frames_repeated = 2;
  report.steps.odometry_rejected = 4;
  report.steps.odometry_jumps = 5;
  report.steps.records_refused = 6;
  report.steps.calls_refused = 7;
  report.steps.mapper.repairs.weights_zeroed = 8;
  report.steps.mapper.repairs.landmarks_dropped = 9;
  JsonLine line;
  write_health(line, report, {RobotLight::kMapping, ""}, {});
  const std::string said(line.finish());
  EXPECT_THAT(said,
              HasSubstr(R"("frames_refused":3,"frames_repeated":2,)"
                        R"("odometry_extrapolated":0,"odometry_rejected":4,"odometry_jumps":5,)"
                        R"("records_refused":6,"calls_refused":7,"created":0)"));
  EXPECT_THAT(said, HasSubstr(R"("repairs":{"travels_refused":0,"particles_moved":0,)"
                              R"("weights_zeroed":8,)"));
  EXPECT_THAT(said, HasSubstr(R"("landmarks_dropped":9,"maps_reset":0})"));
  EXPECT_EQ(report.steps.mapper.repairs.total(), 17u);
}

TEST(TelemetryLines, TellTheVerdictWithCodesAndAdvice) {
  SetupVerdict verdict;
  verdict.state = VerdictState::kWrong;
  verdict.reasons.push_back({SetupCode::kYawWrong, VerdictState::kWrong, 90.0, 6.5, true});
  VerdictLine line;
  write_verdict(line, verdict, {5});
  const std::string said(line.finish());
  EXPECT_THAT(said, HasSubstr(R"("type":"verdict","stamp_ns":5,"state":"wrong","reasons":)"
                              R"({"yaw_wrong":{"severity":"wrong","text":")"));
  EXPECT_THAT(said, HasSubstr("90.0 degrees"));
  EXPECT_THAT(said, HasSubstr(R"(,"since_s":6.5,"active":true}})"));
}

TEST(TelemetryLines, AVerdictFitsWithAllReasons) {
  SetupVerdict verdict;
  for (int i = 0; i < kSetupCodes; ++i) {
    verdict.reasons.push_back(
        {static_cast<SetupCode>(i), VerdictState::kDoubtful, -1.23456789e300, 1e9, false});
  }
  VerdictLine line;
  write_verdict(line, verdict, {INT64_MAX});
  EXPECT_NE(line.finish(), "");
}

// The longest lines that there can be fit.
TEST(TelemetryLines, FitWithTheLargestNumbers) {
  PerceptionReport report;
  std::memset(static_cast<void*>(&report.camera), 0xff, sizeof report.camera);
  std::memset(static_cast<void*>(&report.can), 0xff, sizeof report.can);
  std::memset(static_cast<void*>(&report.wheels), 0xff, sizeof report.wheels);
  std::memset(static_cast<void*>(&report.steps), 0xff, sizeof report.steps);
  report.covariance.fill(-1.23456789e-300);
  report.odometry_covariance.fill(-1.23456789e-300);
  report.velocity_covariance.fill(-1.23456789e-300);
  JsonLine health;
  write_health(health, report, {RobotLight::kFault, std::string(100, 'x')}, {~0U, ~0U, ~0U});
  EXPECT_THAT(std::string(health.finish()), HasSubstr("\"page_faults\""));
  JsonLine pose;
  write_pose(pose, report);
  EXPECT_NE(pose.finish(), "");
  const std::string longest_name(exchange::kMaxName, '"');
  JsonLine alignment;
  write_alignment(alignment, {}, longest_name, {});
  EXPECT_THAT(std::string(alignment.finish()), HasSubstr("\"state\":\"candidate\""));
  LinkStatus status;
  std::memset(static_cast<void*>(&status.radio), 0xff, sizeof status.radio);
  std::memset(static_cast<void*>(&status.link), 0xff, sizeof status.link);
  std::memset(static_cast<void*>(&status.exchange), 0xff, sizeof status.exchange);
  JsonLine radio;
  write_radio(radio, status, {});
  EXPECT_THAT(std::string(radio.finish()), HasSubstr("\"checksum_differed\""));
  LinkPeer robot;
  robot.name.assign(longest_name);
  robot.address.is_ipv6 = true;
  robot.address.address.fill(0xff);
  robot.address.interface = ~0U;
  JsonLine peer;
  write_peer(peer, robot, {});
  EXPECT_THAT(std::string(peer.finish()), HasSubstr("\"complete\":false"));
}

}  // namespace
}  // namespace zenith
