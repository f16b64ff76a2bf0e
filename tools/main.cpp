// zenith: the command line tool around the robots. One file per subcommand: cmd_*.cpp.

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "platform/linux/cpu.h"
#include "platform/linux/printable_output.h"
#include "slam/kernels/isa_in_use.h"
#include "tools/commands.h"
#include "tools/overrides.h"

namespace {

constexpr const char* kFooter =
    R"(Start here:
  zenith demo                          two robots, one map, a picture: no hardware needed
  zenith sim corridor-rooms --out rec  write simulated recordings
  zenith replay rec/* --out out        map them, together
  zenith view out                      look at it in a browser
  zenith eval corridor-rooms           figures against the ground truth

On a robot:
  zenith calibrate --help              lens, mount and wheels
  zenith doctor --config zenith.toml   what is wrong, and what to do
  zenith view                          look at it in a browser
  zenith record rec/anna               record what the running zenithd sees

`zenith COMMAND --help` explains a command with examples; `zenith --parameters` lists what
`--set key=value` can change.)";

int run(int argc, char** argv) {
  using namespace zenith::tools;
  const auto isa = zenith::choose_isa(std::getenv("ZENITH_SIMD"));
  if (!isa) {
    std::fprintf(stderr, "zenith: error: %s\n", isa.error().message.c_str());
    return 2;
  }
  zenith::use_isa(*isa);
  int exit_code = 0;
  CLI::App app("One map by many robots that look at the ceiling.", "zenith");
  app.footer(kFooter);
  app.set_version_flag("--version", "zenith " ZENITH_VERSION);
  app.require_subcommand(0, 1);
  bool list_parameters = false;
  app.add_flag("--parameters", list_parameters, "list the parameters of the algorithm");
  add_demo_command(app, exit_code);
  add_descriptors_command(app, exit_code);
  add_sim_command(app, exit_code);
  add_calibrate_command(app, exit_code);
  add_doctor_command(app, exit_code);
  add_record_command(app, exit_code);
  add_replay_command(app, exit_code);
  add_eval_command(app, exit_code);
  add_key_command(app, exit_code);
  add_map_command(app, exit_code);
  add_view_command(app, exit_code);
  add_telemetry_command(app, exit_code);
  add_metrics_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (list_parameters) {
    std::printf("%s", describe_parameters().c_str());
  } else if (app.get_subcommands().empty()) {
    std::printf("%s", app.help().c_str());
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  zenith::make_output_printable();
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "zenith: error: %s\n", error.what());
    return 1;
  }
}
