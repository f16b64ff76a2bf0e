// zenith doctor: what is wrong with this robot, and what to do.

#include <cstdio>
#include <memory>
#include <string>

#include "tools/commands.h"
#include "tools/doctor/doctor.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Looks at all that a robot needs, a line each: the configuration, the running daemon, the camera,
the CAN bus and the wheels, the lights, the way to other robots, what the kernel grants, clock, heat, power and disk.

  ok    as it should be
  warn  it works, but not as well as it could
  FAIL  it does not work: this first
  skip  not looked at, and why

Nothing is changed. A camera that is not in use is opened for two seconds; the CAN bus is only
listened to. Other users' programs and some devices are seen by root alone: use sudo.

Examples:
  sudo zenith doctor --config /etc/zenith/zenith.toml
  zenith doctor --config zenith.toml --fix-hints      with commands that mend it
  zenith doctor --json | jq '.findings[] | select(.verdict == "fail")'

Exit codes: 0 nothing failed, 1 something did, 2 wrong arguments. docs/doctor.md explains each check.)";

struct DoctorCommand {
  DoctorPlan plan;
  std::string config;
  bool hints = false;
  bool json = false;
};

int run(DoctorCommand& command) {
  command.plan.config = command.config;
  const Findings findings = run_doctor(command.plan, [&command](const Finding& finding) {
    if (command.json) return;
    std::printf("%s", finding_line(finding, command.hints).c_str());
    std::fflush(stdout);
  });
  const std::string end = command.json ? findings_json(findings) : findings_summary(findings);
  std::printf("%s%s", command.json ? "" : "\n", end.c_str());
  return findings_exit_code(findings);
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
  const auto command = std::make_shared<DoctorCommand>();
  CLI::App* doctor = app.add_subcommand("doctor", "Say what is wrong with a robot and what to do");
  doctor->footer(kHelp);
  doctor->add_option("--config", command->config,
                     "the daemon's configuration (/etc/zenith/zenith.toml, else defaults)");
  doctor
      ->add_option("--state", command->plan.state_folder,
                   "the daemon's state folder, in which a relative map.folder lies")
      ->capture_default_str();
  doctor
      ->add_option("--watch", command->plan.watch_s,
                   "seconds for which the camera and the CAN bus are watched")
      ->check(CLI::Range(0.5, 60.0))
      ->capture_default_str();
  doctor->add_flag("--fix-hints", command->hints, "print commands that mend what is wrong");
  doctor->add_flag("--json", command->json, "for machines");
  doctor->callback([command, &exit_code] { exit_code = run(*command); });
}

}  // namespace zenith::tools
