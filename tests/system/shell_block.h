#pragma once
// The commands of a documentation's shell block, as far as their spelling can be checked without
// running them.

#include <string>
#include <vector>

namespace zenith {

struct ShellCommand {
  std::vector<std::string> words;
  int line = 0;  // within the block, from 1
};

// Comments, redirections and what stands between <<WORD and WORD are left out; `a && b` and `a | b`
// are two commands; `sudo a` and `ssh HOST a` are a.
std::vector<ShellCommand> shell_commands(const std::string& block);

// Why this is no command that works anywhere: an option that `--help` of the program does not
// have, a command that `./dev help` does not list (`dev` checks it), a program that no page uses.
// Empty when it is one.
std::string what_is_unknown(const ShellCommand& command, const std::string& dev);

}  // namespace zenith
