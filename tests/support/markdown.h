#pragma once
// The pages of the documentation, as far as tests read them: code blocks, tables, links, headings.
// Not all of Markdown: what these pages use.

#include <filesystem>
#include <string>
#include <vector>

namespace zenith {

// A block between ``` lines.
struct CodeBlock {
  std::string language;  // "" when none is said
  std::string note;      // the comment <!-- ... --> on the line above
  std::string text;
  int line = 0;  // of its first ```
};

struct PageLink {
  std::string target;  // "view.md#the-page", "https://...", "#anchor"
  int line = 0;
};

struct PageLine {
  std::string text;
  int line = 0;
};

struct Page {
  std::filesystem::path path;
  std::vector<CodeBlock> blocks;
  std::vector<PageLine> indented;       // lines of code that stand four spaces in
  std::vector<PageLink> links;          // pictures, too
  std::vector<std::string> anchors;     // of the headings, as GitHub makes them
  std::vector<PageLine> file_mentions;  // `a/b.c`: code in a line that has a slash
  // Rows of the tables, cells without their spaces; rules (|---|) left out.
  std::vector<std::vector<std::string>> rows;
};

Page read_page(const std::filesystem::path& path);

// README.md and all of docs/, besides what other folders have.
std::vector<std::filesystem::path> documentation_pages();

}  // namespace zenith
