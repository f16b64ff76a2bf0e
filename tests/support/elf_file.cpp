#include "tests/support/elf_file.h"

#include <elf.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

namespace zenith {
namespace {

struct Bits32 {
  using Header = Elf32_Ehdr;
  using Segment = Elf32_Phdr;
  using Section = Elf32_Shdr;
  using Entry = Elf32_Dyn;
  using Symbol = Elf32_Sym;
};

struct Bits64 {
  using Header = Elf64_Ehdr;
  using Segment = Elf64_Phdr;
  using Section = Elf64_Shdr;
  using Entry = Elf64_Dyn;
  using Symbol = Elf64_Sym;
};

// `count` structures from `offset` on; none when they do not fit into the file. Offsets of a 64-bit
// file do not fit into a 32-bit program's size_t.
template <typename T>
std::vector<T> structures(const std::string& bytes, std::uint64_t offset, std::uint64_t count) {
  std::vector<T> all;
  if (count == 0 || offset > bytes.size()) return all;
  if (count > (bytes.size() - offset) / sizeof(T)) return all;
  all.resize(static_cast<std::size_t>(count));
  std::memcpy(all.data(), bytes.data() + offset, all.size() * sizeof(T));
  return all;
}

std::string text_at(const std::string& bytes, std::uint64_t offset) {
  if (offset >= bytes.size()) return {};
  const auto begin = static_cast<std::size_t>(offset);
  return bytes.substr(begin, bytes.find('\0', begin) - begin);
}

template <typename Bits>
void read_dynamic(const std::string& bytes, const typename Bits::Section& section,
                  std::uint64_t names, ElfFile& file) {
  using Entry = typename Bits::Entry;
  const std::uint64_t count = section.sh_size / sizeof(Entry);
  for (const Entry& entry : structures<Entry>(bytes, section.sh_offset, count)) {
    const std::uint64_t value = entry.d_un.d_val;
    if (entry.d_tag == DT_RPATH) file.rpath = text_at(bytes, names + value);
    if (entry.d_tag == DT_RUNPATH) file.runpath = text_at(bytes, names + value);
    if (entry.d_tag == DT_TEXTREL) file.relocates_code = true;
    if (entry.d_tag == DT_BIND_NOW) file.binds_at_start = true;
    if (entry.d_tag == DT_FLAGS) {
      if ((value & DF_BIND_NOW) != 0) file.binds_at_start = true;
      if ((value & DF_TEXTREL) != 0) file.relocates_code = true;
    }
    if (entry.d_tag == DT_FLAGS_1 && (value & DF_1_NOW) != 0) file.binds_at_start = true;
    // A module is independent of its position by its kind.
    if (entry.d_tag == DT_FLAGS_1 && (value & DF_1_PIE) != 0) file.position_independent = true;
  }
}

template <typename Bits>
std::optional<ElfFile> read(const std::string& bytes) {
  const auto headers = structures<typename Bits::Header>(bytes, 0, 1);
  if (headers.empty()) return std::nullopt;
  const auto& header = headers[0];
  if (header.e_type != ET_EXEC && header.e_type != ET_DYN) return std::nullopt;
  ElfFile file;
  file.executable_stack = true;
  for (const auto& segment :
       structures<typename Bits::Segment>(bytes, header.e_phoff, header.e_phnum)) {
    if (segment.p_type == PT_INTERP) file.program = true;
    if (segment.p_type == PT_GNU_RELRO) file.read_only_relocations = true;
    if (segment.p_type == PT_GNU_STACK) file.executable_stack = (segment.p_flags & PF_X) != 0;
  }
  const auto sections = structures<typename Bits::Section>(bytes, header.e_shoff, header.e_shnum);
  for (const auto& section : sections) {
    if (section.sh_type != SHT_DYNAMIC && section.sh_type != SHT_DYNSYM) continue;
    if (section.sh_link >= sections.size()) continue;
    const std::uint64_t names = sections[section.sh_link].sh_offset;
    if (section.sh_type == SHT_DYNAMIC) {
      read_dynamic<Bits>(bytes, section, names, file);
      continue;
    }
    using Symbol = typename Bits::Symbol;
    const std::uint64_t count = section.sh_size / sizeof(Symbol);
    for (const Symbol& symbol : structures<Symbol>(bytes, section.sh_offset, count)) {
      if (symbol.st_shndx == SHN_UNDEF) file.imports.insert(text_at(bytes, names + symbol.st_name));
    }
  }
  if (!file.program) file.position_independent = header.e_type == ET_DYN;
  return file;
}

}  // namespace

std::optional<ElfFile> read_elf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  const std::string bytes = text.str();
  if (bytes.compare(0, SELFMAG, ELFMAG) != 0 || bytes.size() < sizeof(Elf64_Ehdr))
    return std::nullopt;
  if (bytes[EI_DATA] != ELFDATA2LSB) return std::nullopt;
  return bytes[EI_CLASS] == ELFCLASS32 ? read<Bits32>(bytes) : read<Bits64>(bytes);
}

}  // namespace zenith
