#include "tests/support/markdown.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>

namespace zenith {
namespace {

namespace fs = std::filesystem;

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool begins(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

// "<!-- needs: a robot -->" -> "needs: a robot"
std::string comment_in(const std::string& line) {
  const std::size_t end = line.find("-->");
  return begins(line, "<!--") && end != std::string::npos ? trimmed(line.substr(4, end - 4)) : "";
}

// "What it shows: `a_b`" -> "what-it-shows-a_b"
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0 || c == '-' || c == '_' || u >= 128) {
      anchor += static_cast<char>(std::tolower(u));
    } else if (c == ' ') {
      anchor += '-';
    }
  }
  return anchor;
}

// "- this", "12. that"
bool is_item(const std::string& line) {
  static const std::regex item(R"(\s*([-*]|\d+\.)\s.*)");
  return std::regex_match(line, item);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  bool code = false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == '`') code = !code;
    if (line[i] == '|' && !code && line[i - 1] != '\\') {
      cells.push_back(trimmed(cell));
      cell.clear();
    } else {
      cell += line[i];
    }
  }
  return cells;
}

void take_text(const std::string& line, int number, Page& page) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  static const std::regex mention(R"(`([A-Za-z0-9_.\-]+/[A-Za-z0-9_./\-]*\*?[A-Za-z0-9_.]*)`)");
  const auto all = [&](const std::regex& what, auto take) {
    for (std::sregex_iterator it(line.begin(), line.end(), what), end; it != end; ++it) {
      take((*it)[1].str());
    }
  };
  all(link, [&](const std::string& target) { page.links.push_back({target, number}); });
  all(mention, [&](const std::string& file) { page.file_mentions.push_back({file, number}); });
  if (begins(line, "#")) {
    page.anchors.push_back(anchor_of(trimmed(line.substr(line.find_first_not_of('#')))));
  }
  if (begins(line, "|") && !begins(line, "|-")) page.rows.push_back(cells_of(line));
}

}  // namespace

Page read_page(const fs::path& path) {
  Page page;
  page.path = path;
  std::ifstream in(path);
  std::string line;
  std::string before;
  CodeBlock block;
  bool in_block = false;
  bool in_list = false;
  bool after_blank = true;
  for (int number = 1; std::getline(in, line); before = line, ++number) {
    const std::string text = trimmed(line);
    if (begins(text, "```")) {
      if (in_block) {
        page.blocks.push_back(block);
      } else {
        block = {trimmed(text.substr(3)), comment_in(trimmed(before)), "", number};
      }
      in_block = !in_block;
      continue;
    }
    if (in_block) {
      block.text += line + "\n";
      continue;
    }
    // In a list what stands four spaces in may be its text: code stands four further in.
    const bool item = is_item(line);
    if (item) in_list = true;
    if (!line.empty() && line[0] != ' ' && !item) in_list = false;
    const bool deep = begins(line, in_list ? "       " : "    ");
    if (deep &&
        (after_blank || (!page.indented.empty() && page.indented.back().line == number - 1))) {
      page.indented.push_back({text, number});
      after_blank = false;
      continue;
    }
    after_blank = text.empty();
    take_text(line, number, page);
  }
  return page;
}

std::vector<fs::path> documentation_pages() {
  const fs::path root = ZENITH_SOURCE_DIR;
  std::vector<fs::path> pages = {root / "README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  std::sort(pages.begin() + 1, pages.end());
  return pages;
}

}  // namespace zenith
