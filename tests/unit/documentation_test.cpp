// The documentation leads where it says: links, files, and what its code blocks are. What the
// blocks do is tested by system/documentation_test.cpp.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "tests/support/markdown.h"

namespace zenith {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

fs::path root() {
  return ZENITH_SOURCE_DIR;
}

std::string place(const Page& page, int line) {
  return page.path.lexically_relative(root()).string() + ":" + std::to_string(line);
}

// All pages, also those beside the sources.
std::vector<fs::path> all_pages() {
  std::vector<fs::path> pages = documentation_pages();
  for (const char* folder :
       {"config", "drivers", "platform", "sim", "slam", "systemd", "tests", "tools"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root() / folder)) {
      if (entry.path().extension() == ".md") pages.push_back(entry.path());
    }
  }
  return pages;
}

// A name with or without `*`.
bool is_there(const fs::path& name) {
  if (name.filename().string().find('*') == std::string::npos) return fs::exists(name);
  if (!fs::is_directory(name.parent_path())) return false;
  const auto [before, after] = [&] {
    const std::string text = name.filename().string();
    const auto star = text.find('*');
    return std::pair{text.substr(0, star), text.substr(star + 1)};
  }();
  for (const auto& entry : fs::directory_iterator(name.parent_path())) {
    const std::string file = entry.path().filename().string();
    if (file.size() >= before.size() + after.size() &&
        file.compare(0, before.size(), before) == 0 &&
        file.compare(file.size() - after.size(), after.size(), after) == 0) {
      return true;
    }
  }
  return false;
}

TEST(Documentation, LinksLeadSomewhere) {
  std::map<fs::path, std::vector<std::string>> anchors;
  std::vector<std::string> lost;
  int followed = 0;
  for (const fs::path& path : all_pages()) {
    const Page page = read_page(path);
    for (const PageLink& link : page.links) {
      if (link.target.find("://") != std::string::npos) continue;
      ++followed;
      const std::size_t hash = link.target.find('#');
      const std::string file = link.target.substr(0, hash);
      const fs::path target = file.empty() ? path : (path.parent_path() / file).lexically_normal();
      if (!fs::exists(target)) {
        lost.push_back(place(page, link.line) + ": there is no " + file);
      } else if (hash != std::string::npos) {
        auto& there = anchors[target];
        if (there.empty()) there = read_page(target).anchors;
        if (std::find(there.begin(), there.end(), link.target.substr(hash + 1)) == there.end()) {
          lost.push_back(place(page, link.line) + ": no heading makes " + link.target);
        }
      }
    }
  }
  EXPECT_THAT(lost, IsEmpty());
  EXPECT_GT(followed, 100) << "links are not found any more";
}

TEST(Documentation, FilesThatItNamesExist) {
  static const std::regex ours(
      "(config|docs|drivers|platform|sim|slam|systemd|tests|toolchain|tools)/.*");
  std::vector<std::string> lost;
  int looked_at = 0;
  for (const fs::path& path : documentation_pages()) {
    const Page page = read_page(path);
    for (const PageLine& file : page.file_mentions) {
      if (!std::regex_match(file.text, ours) || file.text.find("NAME") != std::string::npos) {
        continue;
      }
      ++looked_at;
      if (!is_there(root() / file.text)) {
        lost.push_back(place(page, file.line) + ": there is no " + file.text);
      }
    }
  }
  EXPECT_THAT(lost, IsEmpty());
  EXPECT_GT(looked_at, 80) << "names of files are not found any more";
}

// The mathematics beside the code: each section names the file that has it.
TEST(Documentation, EachSectionOfTheAlgorithmNamesItsFiles) {
  std::ifstream in(root() / "docs" / "algorithm.md");
  std::string line;
  std::string section;
  std::set<std::string> without;
  while (std::getline(in, line)) {
    if (std::regex_match(line, std::regex(R"(## \d+\. .*)"))) {
      section = line;
      without.insert(section);
    } else if (line.find("`slam/") != std::string::npos) {
      without.erase(section);
    }
  }
  EXPECT_THAT(without, IsEmpty());
}

// --- tests that the pages name -------------------------------------------------------------------

// "Suite.Case" of all tests, and "Suite.*".
std::set<std::string> names_of_tests() {
  static const std::regex test(R"(^TEST(?:_F|_P)?\((\w+), (\w+)\))");
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(root() / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    std::ifstream in(entry.path());
    std::string line;
    std::smatch found;
    while (std::getline(in, line)) {
      if (!std::regex_search(line, found, test)) continue;
      names.insert(found[1].str() + "." + found[2].str());
      names.insert(found[1].str() + ".*");
    }
  }
  return names;
}

TEST(Documentation, EachPromiseOfSecurityHasTestsThatExist) {
  const std::set<std::string> tests = names_of_tests();
  const Page page = read_page(root() / "docs" / "security.md");
  static const std::regex named("`([A-Z]\\w*\\.(?:\\w+|\\*))`");
  std::vector<std::string> wrong;
  int promises = 0;
  for (const auto& row : page.rows) {
    if (row.size() != 3 || row[2] == "tests") continue;
    ++promises;
    const std::sregex_iterator first(row[2].begin(), row[2].end(), named);
    if (first == std::sregex_iterator()) wrong.push_back("no test holds: " + row[0]);
    for (auto name = first; name != std::sregex_iterator(); ++name) {
      if (tests.count((*name)[1]) == 0) wrong.push_back("there is no test " + (*name)[1].str());
    }
  }
  EXPECT_THAT(wrong, IsEmpty());
  EXPECT_GE(promises, 20) << "the table of attacks is not found any more";
}

// --- code blocks ---------------------------------------------------------------------------------

// What stands first in a line that somebody is to type.
bool is_command(const std::string& line) {
  static const std::regex command(
      R"((sudo|sudoedit|zenith|zenithd|zenithd-sim|\./dev|build/\S+|tests/\S+/\S+|scp|ssh|apt|apt-get)"
      R"(|systemctl|networkctl|journalctl|curl|cmake|chown|chmod|ip) [^=]*|zenith)");
  return std::regex_match(line, command);
}

TEST(Documentation, CommandsStandWhereTheyAreTested) {
  std::vector<std::string> wrong;
  for (const fs::path& path : documentation_pages()) {
    const Page page = read_page(path);
    for (const PageLine& line : page.indented) {
      if (is_command(line.text)) {
        wrong.push_back(place(page, line.line) + ": '" + line.text + "' belongs into ```sh");
      }
    }
  }
  EXPECT_THAT(wrong, IsEmpty());
}

TEST(Documentation, EachBlockSaysWhatItIs) {
  const std::set<std::string> languages = {"sh", "toml", "ini", "yaml", "json", "text"};
  const std::set<std::string> notes = {"", "until Ctrl-C", "meanwhile"};
  std::vector<std::string> wrong;
  for (const fs::path& path : documentation_pages()) {
    const Page page = read_page(path);
    for (const CodeBlock& block : page.blocks) {
      const bool needs = std::regex_match(block.note, std::regex("needs: .*\\S.*"));
      if (languages.count(block.language) == 0 || (!needs && notes.count(block.note) == 0)) {
        wrong.push_back(place(page, block.line) + ": '" + block.language + "' '" + block.note +
                        "': tests/README.md lists the languages and notes of blocks");
      }
    }
  }
  EXPECT_THAT(wrong, IsEmpty());
}

}  // namespace
}  // namespace zenith
