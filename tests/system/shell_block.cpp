#include "tests/system/shell_block.h"

#include <array>
#include <cstdio>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace zenith {
namespace {

// What Debian or a board brings.
const std::set<std::string>& other_programs() {
  static const std::set<std::string> all = {
      "apt",   "candump",    "cansend",  "cat",       "chmod",      "chown",
      "cmake", "config-pin", "cp",       "curl",      "export",     "install",
      "ip",    "journalctl", "mkdir",    "mv",        "networkctl", "ros2",
      "scp",   "ssh",        "sudoedit", "systemctl", "v4l2-ctl"};
  return all;
}

std::string output_of(const std::string& command, int& code) {
  std::string text;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> part;
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) {
    text.append(part.data(), size);
  }
  code = ::pclose(pipe);
  return text;
}

// The text of `--help`, each asked once; empty when there is no such command.
const std::string& help_of(const std::string& program) {
  static std::map<std::string, std::string> known;
  const auto found = known.find(program);
  if (found != known.end()) return found->second;
  int code = 0;
  std::string text = output_of(program + " --help", code);
  return known[program] = code == 0 ? text : "";
}

bool has_word(const std::string& text, const std::string& word) {
  const std::regex whole("(^|[\\s,])" + word + "($|[\\s,=:])");
  return std::regex_search(text, whole);
}

// Options of our programs against their help, subcommands first.
std::string unknown_option(const ShellCommand& command, std::string program) {
  std::size_t next = 1;
  for (; next < command.words.size() && command.words[next][0] != '-'; ++next) {
    const std::string& help = help_of(program);
    const auto begin = help.find("Subcommands:");
    if (begin == std::string::npos) break;
    const auto end = help.find("\n\n", begin);
    if (!has_word(help.substr(begin, end - begin), command.words[next])) {
      return program + " has no subcommand '" + command.words[next] + "'";
    }
    program += " " + command.words[next];
  }
  const std::string& help = help_of(program);
  if (help.empty()) return program + " --help fails";
  for (; next < command.words.size(); ++next) {
    const std::string option = command.words[next].substr(0, command.words[next].find('='));
    if (option.size() < 2 || option[0] != '-' || option == "--") continue;
    if (!has_word(help, option)) return program + " has no option " + option;
  }
  return "";
}

void split_line(const std::string& line, int number, std::vector<ShellCommand>& commands) {
  std::istringstream in(line);
  ShellCommand command = {{}, number};
  const auto finish = [&] {
    auto& words = command.words;
    if (!words.empty() && words[0] == "sudo") words.erase(words.begin());
    const bool remote = words.size() > 2 && words[0] == "ssh" && words[1][0] != '-';
    if (remote) words.erase(words.begin(), words.begin() + 2);
    if (!words.empty() && words[0] == "sudo") words.erase(words.begin());
    if (!words.empty()) commands.push_back(command);
    words.clear();
  };
  for (std::string word; in >> word;) {
    if (word[0] == '#') break;
    if (word == "&&" || word == "|" || word == ";") {
      finish();
    } else if (word == ">" || word == ">>" || word == "<") {
      in >> word;
    } else if (word.compare(0, 2, "<<") != 0) {
      command.words.push_back(word);
    }
  }
  finish();
}

}  // namespace

std::vector<ShellCommand> shell_commands(const std::string& block) {
  static const std::regex document(R"(<<-?'?(\w+)'?)");
  std::vector<ShellCommand> commands;
  std::istringstream in(block);
  std::string line;
  std::string end;  // of a document within the block
  for (int number = 1; std::getline(in, line); ++number) {
    if (!end.empty()) {
      if (line == end) end.clear();
      continue;
    }
    std::smatch found;
    if (std::regex_search(line, found, document)) end = found[1];
    split_line(line, number, commands);
  }
  return commands;
}

std::string what_is_unknown(const ShellCommand& command, const std::string& dev) {
  const std::string& first = command.words[0];
  const std::string name = first.substr(first.rfind('/') + 1);
  if (name == "zenith") return unknown_option(command, ZENITH_TOOL);
  if (name == "zenithd") return unknown_option(command, ZENITHD);
  if (name == "zenithd-sim") return unknown_option(command, ZENITHD_SIM);
#ifdef ZENITH_ROS2
  if (name == "zenith-ros2") return unknown_option(command, ZENITH_ROS2);
#else
  if (name == "zenith-ros2") return "";  // not built: what it knows is not known
#endif
  if (first == "./dev") {
    std::string line = dev + " --only-look";
    for (std::size_t i = 1; i < command.words.size(); ++i) line += " '" + command.words[i] + "'";
    int code = 0;
    const std::string text = output_of(line, code);
    return code == 0 ? "" : text;
  }
  return other_programs().count(name) != 0 ? "" : "no page uses '" + name + "': a slip of the pen?";
}

}  // namespace zenith
