#pragma once
// The subcommands of `zenith calibrate`, and what their command lines share.

#include <string>

#include <CLI/CLI.hpp>

#include "platform/base/result.h"
#include "tools/calibrate/target.h"

namespace zenith::tools {

void add_calibrate_drive(CLI::App& calibrate, int& exit_code);
void add_calibrate_import(CLI::App& calibrate, int& exit_code);
void add_calibrate_lens(CLI::App& calibrate, int& exit_code);
void add_calibrate_board(CLI::App& calibrate, int& exit_code);
void add_calibrate_sample(CLI::App& calibrate, int& exit_code);

// --target, --squares, --square-mm.
struct TargetOptions {
  std::string kind = "checkerboard";
  std::string squares = "9x6";
  double square_mm = 30.0;

  void add_to(CLI::App& command);
  Result<Target> target() const { return parse_target(kind, squares, square_mm); }
};

}  // namespace zenith::tools
