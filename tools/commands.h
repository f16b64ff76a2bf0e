#pragma once
// The subcommands of `zenith`. Each adds itself to the command line; when it was chosen, its
// callback runs and leaves the exit code: 0 done, 1 failed, 2 wrong use.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "platform/base/result.h"

namespace zenith::tools {

void add_calibrate_command(CLI::App& app, int& exit_code);
void add_sim_command(CLI::App& app, int& exit_code);
void add_record_command(CLI::App& app, int& exit_code);
void add_replay_command(CLI::App& app, int& exit_code);
void add_eval_command(CLI::App& app, int& exit_code);
void add_doctor_command(CLI::App& app, int& exit_code);
void add_demo_command(CLI::App& app, int& exit_code);
void add_descriptors_command(CLI::App& app, int& exit_code);
void add_map_command(CLI::App& app, int& exit_code);
void add_key_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);
void add_telemetry_command(CLI::App& app, int& exit_code);
void add_metrics_command(CLI::App& app, int& exit_code);

// `--set key=value`, once or several times.
void add_set_option(CLI::App& command, std::vector<std::string>& assignments);

// Prints "zenith: error: ..." and returns exit code 1.
int fail(const Error& error);

// Prints "zenith: warning: ...", a line each.
void warn(const std::vector<std::string>& warnings);

}  // namespace zenith::tools
