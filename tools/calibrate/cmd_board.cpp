// zenith calibrate board: the target, to print.

#include <cstdio>
#include <memory>

#include "tools/calibrate/commands.h"
#include "tools/commands.h"

namespace zenith::tools {
namespace {

constexpr const char* kHelp =
    R"(Writes a page with the board, to be printed at 100 % (no "fit to page") and glued to
something flat and stiff. Then measure ten squares with a ruler: --square-mm of `calibrate lens` is what was
printed. A checkerboard must be seen whole; of a charuco board a part is enough, but its markers
need more pixels: take it for cameras of a megapixel and more.

Examples:
  zenith calibrate board --out board.pdf
  zenith calibrate board --out board.pdf --squares 12x9 --square-mm 60
  zenith calibrate board --out board.png --target charuco --squares 8x5 --square-mm 35)";

struct BoardCommand {
  TargetOptions target;
  std::string out;
};

int run_board(const BoardCommand& command) {
  const auto target = command.target.target();
  if (!target) return fail(target.error()) + 1;
  if (const Status written = write_target(*target, command.out); !written) {
    return fail(written.error());
  }
  std::printf("%s: %s, %.0f x %.0f mm; print at 100 %% and measure a square\n", command.out.c_str(),
              target_text(*target).c_str(), 1e3 * target->width_m(), 1e3 * target->height_m());
  return 0;
}

}  // namespace

void TargetOptions::add_to(CLI::App& command) {
  command.add_option("--target", kind, "checkerboard, or charuco: with markers in its squares")
      ->capture_default_str();
  command.add_option("--squares", squares, "COLUMNSxROWS, all squares counted")
      ->capture_default_str();
  command.add_option("--square-mm", square_mm, "side of a square as printed, mm")
      ->capture_default_str();
}

void add_calibrate_board(CLI::App& calibrate, int& exit_code) {
  const auto command = std::make_shared<BoardCommand>();
  CLI::App* board = calibrate.add_subcommand("board", "Write the board to print");
  board->footer(kHelp);
  command->target.add_to(*board);
  board->add_option("--out", command->out, "the page: *.pdf or *.png")->required();
  board->callback([command, &exit_code] { exit_code = run_board(*command); });
}

}  // namespace zenith::tools
