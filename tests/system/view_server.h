#pragma once
// A `zenith view` under test.

#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/patience.h"
#include "tests/system/process.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {

class ViewServer {
 public:
  explicit ViewServer(const std::filesystem::path& folder) : base_((folder / "view").string()) {}

  // `zenith view WORDS...` at any free port; false when it does not come up.
  bool start(std::vector<std::string> words, double limit_s,
             const std::vector<Environment>& environment = {}) {
    words.insert(words.begin(), {"view", "--port", "0"});
    return run(words, limit_s, environment);
  }
  // Another command of zenith that shows a page.
  bool run(std::vector<std::string> words, double limit_s,
           const std::vector<Environment>& environment = {}) {
    words.insert(words.begin(), ZENITH_TOOL);
    process_ = std::make_unique<Process>(words, base_ + ".out", base_ + ".log", environment);
    return wait_until(limit_s, [&] {
      std::smatch match;
      const std::string said = tools::read_text(base_ + ".out");
      if (std::regex_search(said, match,
                            std::regex(R"(http://[^ ]+:([0-9]+)/(\?token=([A-Za-z0-9_-]+))?)"))) {
        address_ = match[0];
        port_ = std::stoi(match[1]);
        token_ = match[3];
      }
      return port_ != 0;
    });
  }
  void kill() { process_.reset(); }
  // The exit code, when it is asked to end.
  int stop() {
    process_->send(SIGINT);
    return wait(kPatience_s);
  }

  int wait(double limit_s) { return process_->wait(limit_s); }

  const std::string& address() const { return address_; }
  int port() const { return port_; }
  const std::string& token() const { return token_; }
  std::string said() const { return tools::read_text(base_ + ".out"); }
  std::string log() const { return tools::read_text(base_ + ".log"); }

 private:
  const std::string base_;
  std::unique_ptr<Process> process_;
  std::string address_;
  std::string token_;
  int port_ = 0;
};

// Two robots of which one joins the other's map after three of four seconds, as a replay's output.
std::string short_timeline();

}  // namespace zenith
