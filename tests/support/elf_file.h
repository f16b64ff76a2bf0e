#pragma once
// What a program or module says of itself to the loader, read from its ELF file, of 32 or 64 bits,
// little-endian. For files that a build has made: contents are not mistrusted beyond their bounds.

#include <filesystem>
#include <optional>
#include <set>
#include <string>

namespace zenith {

struct ElfFile {
  bool program = false;  // asks for a loader: not a module, not a library
  bool position_independent = false;
  bool read_only_relocations = false;
  bool binds_at_start = false;
  bool executable_stack = false;  // also where the file does not say
  bool relocates_code = false;
  std::optional<std::string> rpath;
  std::optional<std::string> runpath;
  std::set<std::string> imports;  // functions and data of other libraries, without versions
};

// Nothing when the file is no ELF file that a loader takes: an object, an archive, a script.
std::optional<ElfFile> read_elf(const std::filesystem::path& path);

}  // namespace zenith
