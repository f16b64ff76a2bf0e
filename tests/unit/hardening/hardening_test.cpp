// Every program and module of the build, as its file is: toolchain/hardening.cmake. And those in
// Debian packages that this state of the sources has made.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/elf_file.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

#if defined(_FORTIFY_SOURCE) && _FORTIFY_SOURCE > 0
constexpr bool kFortified = true;
#else
constexpr bool kFortified = false;  // a build without optimisation
#endif

// With FORTIFY every call of one of these is one of its checked twin, such as __printf_chk.
constexpr const char* kChecked[] = {"printf",  "fprintf",  "sprintf",  "snprintf", "dprintf",
                                    "vprintf", "vfprintf", "vsprintf", "asprintf", "vdprintf"};

bool imports_checked_twin(const ElfFile& file) {
  for (const std::string& name : file.imports) {
    const bool checked = name.size() > 6 && name.compare(0, 2, "__") == 0 &&
                         name.compare(name.size() - 4, 4, "_chk") == 0;
    if (checked) return true;
  }
  return false;
}

// What is wrong with where the loader looks for libraries.
void check_library_path(const ElfFile& file, std::vector<std::string>& faults) {
  if (file.rpath) faults.push_back("RPATH " + *file.rpath);
  if (!file.runpath) return;
  std::string rest = *file.runpath + ":";
  for (std::size_t end = 0; (end = rest.find(':')) != std::string::npos; rest.erase(0, end + 1)) {
    const std::string entry = rest.substr(0, end);
    // A path of the build, or one that anybody could write to, has no business there either.
    if (entry != "$ORIGIN/../lib/zenith") faults.push_back("RUNPATH has '" + entry + "'");
  }
}

std::vector<std::string> hardening_faults(const ElfFile& file) {
  std::vector<std::string> faults;
  if (!file.position_independent) faults.push_back("not position independent");
  if (!file.read_only_relocations) faults.push_back("no RELRO");
  if (!file.binds_at_start) faults.push_back("no BIND_NOW");
  if (file.executable_stack) faults.push_back("executable stack");
  if (file.relocates_code) faults.push_back("TEXTREL");
  if (file.imports.count("__stack_chk_fail") == 0) faults.push_back("no stack protector");
  for (const char* name : kChecked) {
    if (kFortified && file.imports.count(name) != 0 && !imports_checked_twin(file)) {
      faults.push_back(std::string("no FORTIFY: calls ") + name);
    }
  }
  check_library_path(file, faults);
  return faults;
}

// Looks at one file and says so; false when it is none for the loader.
bool look_at(const fs::path& path, const std::string& name) {
  const auto file = read_elf(path);
  if (!file) return false;
  const std::vector<std::string> faults = hardening_faults(*file);
  std::printf("  %-8s %s\n", faults.empty() ? "hardened" : "NOT", name.c_str());
  EXPECT_THAT(faults, IsEmpty()) << path;
  return true;
}

class Hardening : public testing::Test {
 protected:
  void SetUp() override {
    if (*ZENITH_SANITIZERS != '\0') {
      GTEST_SKIP() << "SKIPPED, no program was looked at: this build has the sanitizers "
                   << ZENITH_SANITIZERS << ", whose checks the flags would hide";
    }
  }
};

TEST_F(Hardening, EveryProgramAndModuleOfTheBuildHasIt) {
  std::ifstream list(ZENITH_PROGRAMS);
  ASSERT_TRUE(list) << ZENITH_PROGRAMS;
  int looked_at = 0;
  for (std::string path; std::getline(list, path);) {
    const std::string name = fs::relative(path, ZENITH_BINARY_DIR).string();
    if (!fs::exists(path)) {
      std::printf("  NOT BUILT, not looked at: %s\n", name.c_str());
      continue;
    }
    EXPECT_TRUE(look_at(path, name)) << path << " is no program";
    ++looked_at;
  }
  EXPECT_GE(looked_at, 1) << "nothing was looked at";
  if (!kFortified) std::printf("  FORTIFY was not looked for: it needs optimisation\n");
}

TEST_F(Hardening, AProgramWithoutItIsFound) {
  const auto bare = read_elf(ZENITH_BARE_PROGRAM);
  ASSERT_TRUE(bare);
  const std::vector<std::string> faults = hardening_faults(*bare);
  for (const char* fault :
       {"not position independent", "no RELRO", "no BIND_NOW", "executable stack",
        "no stack protector", "RUNPATH has ''", "RUNPATH has 'lib'", "RUNPATH has '/tmp'"}) {
    EXPECT_THAT(faults, Contains(fault));
  }
  if (kFortified) {
    EXPECT_THAT(faults, Contains("no FORTIFY: calls printf"));
  }
}

// Packages that are older than the flags say nothing about them.
std::vector<fs::path> packages_of_these_flags() {
  const fs::path source = ZENITH_SOURCE_DIR;
  const auto flags = std::max(fs::last_write_time(source / "toolchain/hardening.cmake"),
                              fs::last_write_time(source / "CMakeLists.txt"));
  std::vector<fs::path> packages;
  if (!fs::is_directory(source / "out/packages")) return packages;
  for (const auto& entry : fs::directory_iterator(source / "out/packages")) {
    if (entry.path().extension() != ".deb") continue;
    if (entry.last_write_time() > flags) {
      packages.push_back(entry.path());
    } else {
      std::printf("  OLDER than the flags, not looked at: %s\n", entry.path().c_str());
    }
  }
  return packages;
}

TEST_F(Hardening, ProgramsInPackagesHaveIt) {
  const std::vector<fs::path> packages = packages_of_these_flags();
  if (packages.empty() || std::system("dpkg-deb --version >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "SKIPPED, no package was looked at: ./dev package makes some in out/packages";
  }
  for (const fs::path& package : packages) {
    const tools::TemporaryFolder folder;
    const std::string unpack =
        "dpkg-deb -x '" + package.string() + "' '" + folder.path().string() + "'";
    ASSERT_EQ(std::system(unpack.c_str()), 0) << unpack;
    int looked_at = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
      if (!entry.is_regular_file() || entry.is_symlink()) continue;
      const std::string name =
          package.filename().string() + ": " + fs::relative(entry.path(), folder.path()).string();
      if (look_at(entry.path(), name)) ++looked_at;
    }
    EXPECT_GE(looked_at, 1) << package << " has no program";
  }
}

}  // namespace
}  // namespace zenith
