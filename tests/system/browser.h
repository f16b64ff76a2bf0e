#pragma once
// A real browser without a screen (Chromium), driven through WebDriver as chromedriver speaks it.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/system/process.h"

namespace zenith {

class Browser {
 public:
  // Whether there is one on this machine.
  static bool is_installed();

  // `folder` is for its files. good() is false when it did not start; error() says why.
  explicit Browser(const std::filesystem::path& folder);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  bool good() const { return !session_.empty(); }
  const std::string& error() const { return error_; }

  void show(int width_px, int height_px, bool phone, bool dark);
  void open(const std::string& url);
  // What the script returns.
  nlohmann::json run(const std::string& script);
  // "return ..." becomes true; false after the limit.
  bool wait_for(const std::string& condition, double limit_s);
  void press(const std::string& keys);
  // Of what is seen, as PNG.
  bool save_picture(const std::filesystem::path& file);
  // What the page wrote to the console since the last call.
  std::vector<std::string> console();

 private:
  nlohmann::json call(const std::string& method, const std::string& path,
                      const nlohmann::json& body);
  nlohmann::json ask(const std::string& method, const std::string& path,
                     const nlohmann::json& body = nlohmann::json::object());

  std::unique_ptr<Process> driver_;
  int port_ = 0;
  std::string session_;
  std::string error_;
};

}  // namespace zenith
