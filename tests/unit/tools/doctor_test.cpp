// The checks of the computer, the CAN bus, the lights, the configuration and the daemon: each
// verdict from made-up facts.

#include <sys/socket.h>

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <nlohmann/json.hpp>

#include "drivers/odometry/agilex_v2.h"
#include "drivers/odometry/simulated_can.h"
#include "platform/link/fleet_key.h"
#include "tests/unit/tools/temporary_folder.h"
#include "tools/doctor/check_can.h"
#include "tools/doctor/check_config.h"
#include "tools/doctor/check_daemon.h"
#include "tools/doctor/check_fleet.h"
#include "tools/doctor/check_leds.h"
#include "tools/doctor/check_machine.h"
#include "tools/doctor/doctor.h"

namespace zenith::tools {

void PrintTo(Verdict verdict, std::ostream* out) {
  *out << (verdict == Verdict::kOk     ? "ok"
           : verdict == Verdict::kWarn ? "warn"
           : verdict == Verdict::kFail ? "FAIL"
                                       : "skip");
}

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A finding of this verdict that says so.
MATCHER_P2(Says, verdict, text, "") {
  *result_listener << finding_line(arg, false);
  return arg.verdict == verdict && (arg.found + "; " + arg.todo).find(text) != std::string::npos;
}

class DoctorTest : public testing::Test {
 protected:
  void put(const std::string& path, const std::string& text) {
    const fs::path place = files_.at(path);
    fs::create_directories(place.parent_path());
    write_text(place, text + "\n");
  }

  TemporaryFolder folder_;
  const MachineFiles files_{folder_.path()};
  const RealtimeConfig realtime_;
};

// --- how findings are told -----------------------------------------------------------------------

TEST(Findings, AreALineEachAndDecideTheExitCode) {
  Findings findings = {ok("a", "fine"), warn("b", "so so\nindeed", "do it", "one\ntwo"),
                       skip("c", "no need")};
  EXPECT_EQ(finding_line(findings[0], true), "ok    a                  - fine\n");
  EXPECT_EQ(finding_line(findings[1], false), "warn  b                  - so so indeed; do it\n");
  EXPECT_EQ(finding_line(findings[1], true),
            "warn  b                  - so so indeed; do it\n          one\n          two\n");
  EXPECT_EQ(findings_exit_code(findings), 0) << "warnings do not fail";
  findings.push_back(fail("d", "bad \xFF", "mend it"));
  EXPECT_EQ(findings_exit_code(findings), 1);
  EXPECT_EQ(findings_summary(findings), "4 checks: 1 ok, 1 warning, 1 failed, 1 skipped\n");
  const auto json = nlohmann::json::parse(findings_json(findings));
  EXPECT_EQ(json["findings"].size(), 4u);
  EXPECT_EQ(json["findings"][3]["verdict"], "fail");
  EXPECT_EQ(json["failed"], 1);
}

// --- configuration -------------------------------------------------------------------------------

TEST_F(DoctorTest, EachMistakeOfTheConfigurationIsAFinding) {
  std::optional<DaemonConfig> config;
  const fs::path file = folder_.path() / "zenith.toml";
  write_text(file, "[camera]\nrate_hz = -1\nexposre = 3\n");
  const Findings wrong = check_config(file, config);
  ASSERT_EQ(wrong.size(), 2u);
  EXPECT_THAT(wrong[0], Says(Verdict::kFail, ":2: camera.rate_hz"));
  EXPECT_THAT(wrong[1], Says(Verdict::kFail, ":3: unknown key camera.exposre"));
  EXPECT_FALSE(config.has_value());
  write_text(file, "[robot]\nname = \"ada\"\n");
  EXPECT_THAT(check_config(file, config).at(0), Says(Verdict::kOk, "robot ada"));
  ASSERT_TRUE(config.has_value());
  const fs::path none = folder_.path() / "none.toml";
  EXPECT_THAT(check_config(none, config).at(0), Says(Verdict::kFail, "missing"));
  EXPECT_THAT(check_config("", config, none).at(0), Says(Verdict::kWarn, "with defaults"));
  EXPECT_THAT(check_config("", config, file).at(0), Says(Verdict::kOk, "robot ada"));
}

// --- realtime ------------------------------------------------------------------------------------

TEST_F(DoctorTest, LimitsAreComparedWithWhatIsAskedFor) {
  LimitFacts facts = {{0, 8 << 20}, "this shell", false};
  EXPECT_THAT(check_fifo(realtime_, facts), Says(Verdict::kWarn, "LimitRTPRIO="));
  EXPECT_THAT(check_locked_memory(realtime_, facts), Says(Verdict::kWarn, "8192 KiB"));
  facts.limits = {50, RealtimeLimits::kUnlimited};
  EXPECT_THAT(check_fifo(realtime_, facts), Says(Verdict::kOk, "50 for this shell"));
  EXPECT_THAT(check_locked_memory(realtime_, facts), Says(Verdict::kOk, "no limit"));
  facts = {{0, 0}, "this shell", true};
  EXPECT_THAT(check_fifo(realtime_, facts), Says(Verdict::kOk, "root"));
  EXPECT_THAT(check_locked_memory(realtime_, facts), Says(Verdict::kOk, "root"));
  RealtimeConfig none;
  none.priority = 0;
  none.lock_memory = false;
  none.hold_cpu_awake = false;
  EXPECT_EQ(check_fifo(none, facts).verdict, Verdict::kSkip);
  EXPECT_EQ(check_locked_memory(none, facts).verdict, Verdict::kSkip);
  EXPECT_EQ(check_cpu_dma_latency(none, files_).verdict, Verdict::kSkip);
}

TEST_F(DoctorTest, LimitsOfARunningProcessAreRead) {
  put("/proc/812/limits",
      "Limit                     Soft Limit           Hard Limit           Units     \n"
      "Max locked memory         67108864             unlimited            bytes     \n"
      "Max realtime priority     50                   60                             ");
  put("/proc/812/status", "Name:\tzenithd\nUid:\t991\t991\t991\t991");
  LimitFacts facts;
  ASSERT_TRUE(read_process_limits(files_, 812, facts));
  EXPECT_EQ(facts.limits.fifo_priority, 50u);
  EXPECT_EQ(facts.limits.locked_bytes, 67108864u);
  EXPECT_FALSE(facts.is_root);
  put("/proc/812/status", "Name:\tzenithd\nUid:\t0\t0\t0\t0");
  ASSERT_TRUE(read_process_limits(files_, 812, facts));
  EXPECT_TRUE(facts.is_root);
  EXPECT_FALSE(read_process_limits(files_, 813, facts));
}

TEST_F(DoctorTest, TheCpusShouldBeAwakeAndQuick) {
  EXPECT_THAT(check_cpu_dma_latency(realtime_, files_), Says(Verdict::kWarn, "is not there"));
  put("/dev/cpu_dma_latency", "");
  EXPECT_EQ(check_cpu_dma_latency(realtime_, files_).verdict, Verdict::kOk);

  EXPECT_THAT(check_governor(files_), Says(Verdict::kOk, "does not change"));
  const std::string cpu = "/sys/devices/system/cpu/cpu";
  put(cpu + "0/cpufreq/scaling_governor", "performance");
  put(cpu + "1/cpufreq/scaling_governor", "performance");
  EXPECT_THAT(check_governor(files_), Says(Verdict::kOk, "performance on 2"));
  put(cpu + "1/cpufreq/scaling_governor", "powersave");
  EXPECT_THAT(check_governor(files_), Says(Verdict::kWarn, "powersave on 1"));
  put(cpu + "0/cpufreq/scaling_driver", "intel_pstate");
  EXPECT_EQ(check_governor(files_).verdict, Verdict::kOk);
}

TEST_F(DoctorTest, TheKernelsKindAndItsBudgetForRealtime) {
  put("/proc/version", "Linux version 6.1 #1 SMP Debian");
  EXPECT_THAT(check_preemption(files_), Says(Verdict::kWarn, "none"));
  put("/proc/version", "Linux version 6.1 #1 SMP PREEMPT Debian");
  EXPECT_THAT(check_preemption(files_), Says(Verdict::kOk, "PREEMPT"));
  put("/proc/version", "Linux version 6.1 #1 SMP PREEMPT_DYNAMIC Debian");
  EXPECT_THAT(check_preemption(files_), Says(Verdict::kOk, "PREEMPT_DYNAMIC"));
  put("/sys/kernel/realtime", "1");
  EXPECT_THAT(check_preemption(files_), Says(Verdict::kOk, "PREEMPT_RT"));

  EXPECT_EQ(check_rt_throttling(realtime_, files_).verdict, Verdict::kSkip);
  put("/proc/sys/kernel/sched_rt_runtime_us", "950000");
  put("/proc/sys/kernel/sched_rt_period_us", "1000000");
  EXPECT_THAT(check_rt_throttling(realtime_, files_), Says(Verdict::kOk, "95 %"));
  put("/proc/sys/kernel/sched_rt_runtime_us", "-1");
  EXPECT_THAT(check_rt_throttling(realtime_, files_), Says(Verdict::kOk, "no limit"));
  put("/proc/sys/kernel/sched_rt_runtime_us", "50000");
  EXPECT_THAT(check_rt_throttling(realtime_, files_), Says(Verdict::kFail, "5 %"));
}

// --- clock, heat, power, disk --------------------------------------------------------------------

TEST_F(DoctorTest, Clocks) {
  const std::string current = "/sys/devices/system/clocksource/clocksource0/current_clocksource";
  EXPECT_EQ(check_clock_source(files_).verdict, Verdict::kSkip);
  put(current, "arch_sys_counter");
  EXPECT_THAT(check_clock_source(files_), Says(Verdict::kOk, "arch_sys_counter"));
  put(current, "hpet");
  EXPECT_THAT(check_clock_source(files_), Says(Verdict::kWarn, "hpet"));

  EXPECT_EQ(check_clock_sync({false, false, 0.0, true}).verdict, Verdict::kSkip);
  EXPECT_THAT(check_clock_sync({true, false, 0.0, true}), Says(Verdict::kWarn, "not synchronised"));
  EXPECT_THAT(check_clock_sync({true, true, 0.002, true}), Says(Verdict::kOk, "0.002 s"));
  EXPECT_EQ(check_monotonic({true, true, 0.0, true}).verdict, Verdict::kOk);
  EXPECT_EQ(check_monotonic({true, true, 0.0, false}).verdict, Verdict::kFail);
  EXPECT_TRUE(read_clock().monotonic_rises);
}

TEST_F(DoctorTest, HeatAndPower) {
  EXPECT_EQ(check_temperature(files_).verdict, Verdict::kSkip);
  put("/sys/class/thermal/thermal_zone0/temp", "45000");
  put("/sys/class/thermal/thermal_zone0/type", "cpu-thermal");
  EXPECT_THAT(check_temperature(files_), Says(Verdict::kOk, "45 C (cpu-thermal)"));
  put("/sys/class/thermal/thermal_zone1/temp", "74000");
  EXPECT_THAT(check_temperature(files_), Says(Verdict::kWarn, "74 C"));
  put("/sys/class/thermal/thermal_zone1/temp", "83000");
  EXPECT_THAT(check_temperature(files_), Says(Verdict::kFail, "83 C"));

  EXPECT_EQ(check_power(files_).verdict, Verdict::kSkip);
  put("/sys/class/hwmon/hwmon3/name", "rpi_volt");
  put("/sys/class/hwmon/hwmon3/in0_lcrit_alarm", "0");
  EXPECT_EQ(check_power(files_).verdict, Verdict::kOk);
  put("/sys/class/hwmon/hwmon3/in0_lcrit_alarm", "1");
  EXPECT_THAT(check_power(files_), Says(Verdict::kFail, "under-voltage"));
}

TEST_F(DoctorTest, Disks) {
  EXPECT_EQ(check_disk("/x", 5.0).verdict, Verdict::kFail);
  EXPECT_EQ(check_disk("/x", 300.0).verdict, Verdict::kWarn);
  EXPECT_THAT(check_disk("/x", 9000.0), Says(Verdict::kOk, "9000 MB free at /x"));
  EXPECT_EQ(check_disk("/x", free_disk_mb("/no/such/folder")).verdict, Verdict::kSkip);
  EXPECT_GE(free_disk_mb("/"), 0.0);
}

TEST_F(DoctorTest, TheFolderOfTheMap) {
  storage::FolderFacts facts;
  const auto check = [&](int pid) { return check_map_folder("/maps", facts, "ada", pid); };
  EXPECT_THAT(check(0), Says(Verdict::kFail, "/maps is not there"));
  facts.exists = true;
  EXPECT_THAT(check(0), Says(Verdict::kFail, "/maps is no folder"));
  facts = {true, true, false, "zenith", 900.0, std::nullopt, true};
  EXPECT_THAT(check(0), Says(Verdict::kWarn, "of zenith, cannot be written by this user"));
  facts.writable = true;
  EXPECT_THAT(check(0), Says(Verdict::kOk, "not in use"));
  EXPECT_THAT(check(812), Says(Verdict::kFail, "the running zenithd does not have it"));
  facts.user = {812, "zenithd", "ada"};
  EXPECT_THAT(check(812), Says(Verdict::kOk, "in use by zenithd (pid 812, robot ada)"));
  facts.user = {813, "zenithd", "bert"};
  EXPECT_THAT(check(812), Says(Verdict::kFail, "in use by zenithd (pid 813, robot bert)"));
  facts.user = {814, "zenith", ""};
  EXPECT_THAT(check(0), Says(Verdict::kFail, "in use by zenith (pid 814)"));
  facts = {true, true, true, "zenith", 900.0, std::nullopt, false};
  EXPECT_EQ(check(812).verdict, Verdict::kOk) << "this user cannot see who has it";
}

// Not the default one: with a file that names another folder that one is looked at.
TEST_F(DoctorTest, LooksAtTheConfiguredFolder) {
  const std::string maps = (folder_.path() / "maps").string();
  const std::string file = (folder_.path() / "zenith.toml").string();
  const auto found = [&](const std::string& configured) {
    write_text(file,
               "[robot]\nname = \"ada\"\n[camera]\ndriver = \"simulated\"\n[odometry]\n"
               "driver = \"simulated\"\n[telemetry]\nenabled = false\n[map]\nfolder = \"" +
                   configured + "\"\n");
    DoctorPlan plan;
    plan.config = file;
    plan.state_folder = folder_.path().string();
    std::string text;
    for (const Finding& finding : run_doctor(plan, [](const Finding&) {})) {
      if (finding.what == "map folder" || finding.what == "disk") text += finding.found + "\n";
    }
    return text;
  };
  EXPECT_THAT(found(maps), HasSubstr(maps + " is not there"));
  std::filesystem::create_directory(maps);
  EXPECT_THAT(found(maps), HasSubstr(" free at " + maps));
  EXPECT_THAT(found("maps"), HasSubstr(maps + ", of ")) << "relative: in the state folder";
  EXPECT_THAT(found(""), HasSubstr("no map is kept"));
  storage::FolderLock lock;
  ASSERT_TRUE(lock.take(maps, {7, "zenithd", "bert"}).ours());
  EXPECT_THAT(found("maps"), HasSubstr("in use by zenithd (pid 7, robot bert)"));
}

TEST_F(DoctorTest, WhoHasADevice) {
  put("/dev/video0", "");
  put("/proc/41/comm", "cheese");
  put("/proc/42/comm", "other");
  fs::create_directories(files_.at("/proc/41/fd"));
  fs::create_directories(files_.at("/proc/42/fd"));
  fs::create_symlink(fs::canonical(files_.at("/dev/video0")), files_.at("/proc/41/fd/7"));
  fs::create_symlink("/dev/null", files_.at("/proc/42/fd/1"));
  fs::create_directories(files_.at("/dev/v4l/by-id"));
  fs::create_symlink("../../video0", files_.at("/dev/v4l/by-id/cam"));
  for (const char* name : {"/dev/video0", "/dev/v4l/by-id/cam"}) {
    const auto users = users_of(files_, name);
    ASSERT_EQ(users.size(), 1u) << name;
    EXPECT_EQ(users[0].pid, 41);
    EXPECT_EQ(users[0].name, "cheese");
  }
  EXPECT_TRUE(users_of(files_, "/dev/video9").empty());
}

// --- CAN -----------------------------------------------------------------------------------------

TEST_F(DoctorTest, CanInterfaces) {
  CanLink link = read_can_link(files_, "can0");
  EXPECT_THAT(check_can_interface("can0", link, {"can1"}),
              Says(Verdict::kFail, "there; CAN interfaces: can1"));
  put("/sys/class/net/can0/type", "1");
  put("/sys/class/net/can0/flags", "0x1003");
  link = read_can_link(files_, "can0");
  EXPECT_THAT(check_can_interface("can0", link, {}), Says(Verdict::kFail, "no CAN interface"));
  put("/sys/class/net/can0/type", "280");
  put("/sys/class/net/can0/flags", "0x40080");
  put("/sys/class/net/can0/statistics/rx_packets", "7");
  link = read_can_link(files_, "can0");
  EXPECT_EQ(link.received, 7u);
  EXPECT_THAT(check_can_interface("can0", link, {}), Says(Verdict::kFail, "is down"));
  EXPECT_EQ(check_can_controller("can0", link).verdict, Verdict::kSkip);
  put("/sys/class/net/can0/flags", "0x400c1");
  link = read_can_link(files_, "can0");
  EXPECT_EQ(check_can_interface("can0", link, {}).verdict, Verdict::kOk);
  EXPECT_THAT(list_can_interfaces(files_), testing::ElementsAre("can0"));
}

TEST_F(DoctorTest, CanControllers) {
  CanLink link;
  link.is_can = link.up = true;
  link.controller.kind = "vcan";
  EXPECT_THAT(check_can_controller("vcan0", link), Says(Verdict::kOk, "vcan"));
  link.controller = {"can", CAN_STATE_ERROR_ACTIVE, 500000, 100, 0, 0};
  EXPECT_THAT(check_can_controller("can0", link), Says(Verdict::kOk, "error-active, 500 kbit/s"));
  link.controller.restart_ms = 0;
  EXPECT_THAT(check_can_controller("can0", link), Says(Verdict::kWarn, "stays off"));
  link.controller.state = CAN_STATE_ERROR_PASSIVE;
  EXPECT_THAT(check_can_controller("can0", link), Says(Verdict::kWarn, "error-passive"));
  link.controller.state = CAN_STATE_BUS_OFF;
  EXPECT_THAT(check_can_controller("can0", link), Says(Verdict::kFail, "bus-off"));
}

// An answer of the kernel's, put together attribute by attribute.
class Answer {
 public:
  Answer() : bytes_(sizeof(nlmsghdr) + sizeof(ifinfomsg)) {
    reinterpret_cast<nlmsghdr*>(bytes_.data())->nlmsg_type = RTM_NEWLINK;
  }
  std::size_t begin(unsigned short type) {
    const rtattr head = {0, type};
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&head);
    const std::size_t at = bytes_.size();
    bytes_.insert(bytes_.end(), raw, raw + sizeof(head));
    return at;
  }
  void end(std::size_t at) {
    const auto length = static_cast<unsigned short>(bytes_.size() - at);
    std::memcpy(bytes_.data() + at, &length, sizeof(length));
    bytes_.resize((bytes_.size() + 3) & ~std::size_t{3});
  }
  void add(unsigned short type, const void* data, std::size_t size) {
    const std::size_t at = begin(type);
    const auto* raw = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), raw, raw + size);
    end(at);
  }
  std::vector<std::uint8_t> bytes_;
};

TEST_F(DoctorTest, TheKernelsAnswerAboutAController) {
  Answer answer;
  answer.add(IFLA_IFNAME, "can0", 5);
  const std::size_t info = answer.begin(IFLA_LINKINFO | NLA_F_NESTED);
  answer.add(IFLA_INFO_KIND, "can", 4);
  const std::size_t data = answer.begin(IFLA_INFO_DATA);
  can_bittiming timing = {};
  timing.bitrate = 250000;
  answer.add(IFLA_CAN_BITTIMING, &timing, sizeof(timing));
  const std::uint32_t state = CAN_STATE_ERROR_WARNING;
  answer.add(IFLA_CAN_STATE, &state, sizeof(state));
  const std::uint32_t restart = 100;
  answer.add(IFLA_CAN_RESTART_MS, &restart, sizeof(restart));
  const can_berr_counter errors = {97, 3};
  answer.add(IFLA_CAN_BERR_COUNTER, &errors, sizeof(errors));
  answer.end(data);
  answer.end(info);
  const CanController c = parse_can_controller(answer.bytes_);
  EXPECT_EQ(c.kind, "can");
  EXPECT_EQ(c.bitrate, 250000u);
  EXPECT_EQ(c.state, state);
  EXPECT_EQ(c.restart_ms, 100u);
  EXPECT_EQ(c.transmit_errors, 97u);
  EXPECT_EQ(c.receive_errors, 3u);
  // Cut anywhere, it does no harm (sanitizers look).
  for (std::size_t size = 0; size < answer.bytes_.size(); ++size) {
    (void)parse_can_controller(std::span(answer.bytes_).first(size));
  }
  // The kernel's own answer about an interface without a controller.
  const std::string lo = ask_can_controller("lo");
  EXPECT_EQ(
      parse_can_controller({reinterpret_cast<const std::uint8_t*>(lo.data()), lo.size()}).kind, "");
}

TEST_F(DoctorTest, WhatComesOnTheBus) {
  SimulatedCanBus bus;
  CanFrame stranger;
  stranger.id = 0x123;
  ASSERT_TRUE(bus.open().ok());
  TrafficFacts facts = listen_to(bus, WheelDecoder(), {30'000'000});
  EXPECT_THAT(check_can_traffic("can0", facts), Says(Verdict::kFail, "nothing came on can0"));
  EXPECT_EQ(check_wheels(facts, {}, "agilex_v2").verdict, Verdict::kSkip);

  facts = {};
  facts.seconds = 2.0;
  facts.by_id[{0x123, false}] = 200;
  facts.counters.frames = 200;
  facts.decoder.unknown_ids = 200;
  EXPECT_THAT(check_can_traffic("can0", facts),
              Says(Verdict::kOk, "100 a second, identifiers 0x123"));
  EXPECT_THAT(check_wheels(facts, WheelDecoder().ids(), "agilex_v2"),
              Says(Verdict::kFail, "reads 0x311, none of which came; on the bus: 0x123"));
  facts.by_id[{0x311, true}] = 100;
  EXPECT_THAT(check_wheels(facts, WheelDecoder().ids(), "agilex_v2"),
              Says(Verdict::kFail, "reads 0x311; what came is 0x00000311 (29 bits)"));
  facts.decoder = {};
  facts.decoder.short_frames = 200;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kFail, "200 too short"));
  facts.decoder = {};
  facts.decoder.samples = 40;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kWarn, "20 a second"));
  facts.decoder.samples = 200;
  facts.distinct_travel = 90;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kOk, "100 a second by vesc, driving"));
  facts.fault.kind = WheelFaultKind::kLeftStands;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kFail, "the left wheel never moved"));
  facts.fault = {};
  facts.decoder.invalid = 2;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kWarn, "2 refused"));
  facts.decoder.error_reports = 1;
  EXPECT_THAT(check_wheels(facts, {}, "vesc"), Says(Verdict::kWarn, "reports an error"));
  facts.counters.error_frames = 3;
  EXPECT_THAT(check_can_traffic("can0", facts), Says(Verdict::kWarn, "3 error frames"));
  facts.problem = "it is down";
  EXPECT_THAT(check_can_traffic("can0", facts), Says(Verdict::kFail, "it is down"));
}

// --- lights --------------------------------------------------------------------------------------

TEST_F(DoctorTest, Lights) {
  LedSettings leds;
  EXPECT_EQ(check_leds(leds, {}, "", files_).at(0).verdict, Verdict::kSkip);
  leds.leds[0].name = "gpio:STATUS";
  leds.leds[1].name = "led:green";
  EXPECT_THAT(check_leds(leds, {}, "no chips here", files_).at(0),
              Says(Verdict::kFail, "no chips here"));
  GpioChipInfo chip = {"/dev/gpiochip0", "gpiochip0", "pins", {{"A", "", false}}};
  EXPECT_THAT(check_leds(leds, {chip}, "", files_).at(0), Says(Verdict::kFail, "no such line"));
  chip.lines.push_back({"STATUS", "", false});
  EXPECT_THAT(check_leds(leds, {chip}, "", files_).at(0),
              Says(Verdict::kOk, "/dev/gpiochip0 line 1 (STATUS), free"));
  chip.lines[1] = {"STATUS", "zenith", true};
  EXPECT_THAT(check_leds(leds, {chip}, "", files_).at(0), Says(Verdict::kOk, "by zenithd"));
  chip.lines[1] = {"STATUS", "spi0", true};
  EXPECT_THAT(check_leds(leds, {chip}, "", files_).at(0), Says(Verdict::kFail, "by 'spi0'"));

  put("/sys/class/leds/red/brightness", "0");
  EXPECT_THAT(check_leds(leds, {chip}, "", files_).at(1),
              Says(Verdict::kFail, "LEDs of this kernel: red"));
  leds.leds[1].name = "led:red";
  EXPECT_EQ(check_leds(leds, {chip}, "", files_).at(1).verdict, Verdict::kOk);
}

// --- other robots
// ---------------------------------------------------------------------------------

TEST_F(DoctorTest, TheFleetsKey) {
  RadioConfig radio;
  EXPECT_THAT(check_fleet_key(radio), Says(Verdict::kSkip, "names none"));
  const std::string file = radio.key_file = (folder_.path() / "fleet.key").string();
  EXPECT_THAT(check_fleet_key(radio), Says(Verdict::kFail, file));
  ASSERT_TRUE(create_fleet_key(file).ok());
  EXPECT_THAT(check_fleet_key(radio), Says(Verdict::kOk, "key "));
  ASSERT_TRUE(rotate_fleet_key(file).ok());
  EXPECT_THAT(check_fleet_key(radio), Says(Verdict::kOk, " only opens"));
  fs::permissions(file, fs::perms::others_read, fs::perm_options::add);
  EXPECT_THAT(check_fleet_key(radio), Says(Verdict::kFail, "chmod"));
  fs::remove(file);
  write_text(file, "zenith-fleet-key 1\nshort\n");
  fs::permissions(file, fs::perms::owner_read);
  EXPECT_EQ(check_fleet_key(radio).verdict, Verdict::kFail);
  radio.enabled = false;
  EXPECT_EQ(check_fleet_key(radio).verdict, Verdict::kSkip);
}

TEST_F(DoctorTest, TheWayToOtherRobots) {
  EXPECT_THAT(check_network({{"wlan0", 3}}, ""), Says(Verdict::kOk, "wlan0"));
  EXPECT_THAT(check_network({{"lo", 1}}, ""), Says(Verdict::kWarn, "no interface is up"));
  EXPECT_THAT(check_network({}, "wlan7"), Says(Verdict::kWarn, "wlan7 is not up"));
  EXPECT_TRUE(joined_interfaces(files_, "239.255.90.78").empty());
  put("/proc/net/igmp",
      "Idx\tDevice    : Count Querier\tGroup    Users Timer\tReporter\n"
      "1\tlo        :     1      V3\n\t\t\t\t010000E0     1 0:00000000\t\t0\n"
      "3\twlan0     :     2      V3\n\t\t\t\t4E5AFFEF     1 0:00000000\t\t1\n"
      "\t\t\t\t010000E0     1 0:00000000\t\t0");
  const auto joined = joined_interfaces(files_, "239.255.90.78");
  EXPECT_THAT(joined, testing::ElementsAre("wlan0"));
  EXPECT_THAT(check_group("239.255.90.78", joined, true), Says(Verdict::kOk, "wlan0"));
  EXPECT_THAT(check_group("239.255.90.78", {}, true), Says(Verdict::kFail, "has not joined"));
  EXPECT_THAT(check_group("239.255.90.78", {}, false), Says(Verdict::kSkip, "when it runs"));
}

// --- the daemon ----------------------------------------------------------------------------------

TEST_F(DoctorTest, TheDaemonsTelemetry) {
  DaemonFacts facts;
  facts.path = "/run/zenith/telemetry.sock";
  EXPECT_THAT(check_daemon(facts).at(0), Says(Verdict::kSkip, "none is running"));
  facts.problem = facts.path + ": Permission denied";
  EXPECT_THAT(check_daemon(facts).at(0), Says(Verdict::kWarn, "sudo"));
  facts.running = true;
  EXPECT_THAT(check_daemon(facts).at(0), Says(Verdict::kFail, "says nothing"));
  facts.lines = {"rubbish", R"({"type":"hello","robot":"ada","version":"9","devices":"d"})"};
  EXPECT_THAT(check_daemon(facts).at(0), Says(Verdict::kOk, "robot ada, version 9"));
  EXPECT_THAT(check_daemon(facts).at(1), Says(Verdict::kFail, "tells none"));

  const auto with = [&](const std::string& state, const std::string& up, int missed,
                        int explained) {
    DaemonFacts all = facts;
    all.lines.push_back(R"({"type":"health","state":")" + state +
                        R"(","reason":"","camera":{"up":)" + up +
                        R"(,"frames":90,"lost":0},"can":{"up":true,"lost":1},)"
                        R"("wheels":{"samples":900},"cooperation":{"received":0}})");
    all.lines.push_back(R"({"type":"deadlines","met":90,"missed":)" + std::to_string(missed) +
                        R"(,"explained":)" + std::to_string(explained) + "}");
    return check_daemon(all);
  };
  Findings good = with("mapping", "true", 0, 0);
  ASSERT_EQ(good.size(), 5u);
  EXPECT_THAT(good[1], Says(Verdict::kOk, "mapping"));
  EXPECT_THAT(good[2], Says(Verdict::kWarn, "lost and opened again 1 times"));
  EXPECT_THAT(good[3], Says(Verdict::kOk, "0 of 90"));
  EXPECT_THAT(good[4], Says(Verdict::kSkip, "nothing of a radio"));
  const auto with_radio = [&](const std::string& fields) {
    facts.lines.push_back(R"({"type":"radio",)" + fields + "}");
    const Finding finding = with("mapping", "true", 0, 0)[4];
    facts.lines.pop_back();
    return finding;
  };
  EXPECT_THAT(with_radio(R"("enabled":false)"), Says(Verdict::kOk, "maps alone"));
  EXPECT_THAT(with_radio(R"("enabled":true,"open":false)"), Says(Verdict::kFail, "not open"));
  const std::string open = R"("enabled":true,"open":true,"peers":)";
  EXPECT_THAT(with_radio(open + "2"), Says(Verdict::kOk, "2 peers"));
  EXPECT_THAT(with_radio(open + R"(0,"rejected":{"other_key":3})"),
              Says(Verdict::kWarn, "another key"));
  EXPECT_THAT(with_radio(open + R"(0,"udp":{"forbidden":3})"), Says(Verdict::kWarn, "firewall"));
  EXPECT_THAT(with("fault", "true", 0, 0)[1], Says(Verdict::kFail, "fault"));
  EXPECT_THAT(with("degraded", "true", 0, 0)[1], Says(Verdict::kWarn, "degraded"));
  EXPECT_THAT(with("mapping", "false", 0, 0)[2], Says(Verdict::kFail, "camera down"));
  EXPECT_THAT(with("mapping", "true", 10, 9)[3], Says(Verdict::kWarn, "other programs"));
  EXPECT_THAT(with("mapping", "true", 10, 1)[3], Says(Verdict::kWarn, "too slow"));
}

TEST_F(DoctorTest, TelemetryOfWrongTypesEndsNothing) {
  DaemonFacts facts;
  facts.running = true;
  facts.lines = {R"({"type":5})",
                 R"({"type":"hello","robot":7})",
                 R"({"type":"hello","robot":"\u001b[2J"})",
                 R"({"type":"health","state":[],"camera":7})",
                 R"({"type":"health","state":"mapping","camera":{"up":"x"}})",
                 R"({"type":"radio","enabled":"x","udp":[]})",
                 std::string(100'000, '[')};
  EXPECT_THAT(check_daemon(facts).at(0), Says(Verdict::kFail, "says nothing"));
  facts.lines.push_back(R"({"type":"health","state":"mapping"})");
  facts.lines.push_back(R"({"type":"radio","enabled":{},"open":7})");
  EXPECT_THAT(check_daemon(facts).at(1), Says(Verdict::kOk, "mapping"));
}

}  // namespace
}  // namespace zenith::tools
