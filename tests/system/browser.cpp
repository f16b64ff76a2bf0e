#include "tests/system/browser.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <fstream>
#include <regex>

#include "platform/base/base64.h"
#include "platform/linux/unique_fd.h"
#include "tests/support/patience.h"
#include "tests/unit/tools/temporary_folder.h"

namespace zenith {
namespace {

using nlohmann::json;

constexpr const char* kDriver = "/usr/bin/chromedriver";
constexpr const char* kBrowser = "/usr/bin/chromium";

// The driver keeps the connection open after its answer.
bool is_whole(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  if (end == std::string::npos) return false;
  std::smatch match;
  const std::string head = answer.substr(0, end);
  const bool found =
      std::regex_search(head, match, std::regex("content-length: *([0-9]+)", std::regex::icase));
  return answer.size() >= end + 4 + (found ? std::stoul(match[1]) : 0);
}

// One request, one answer; empty when there is none.
std::string http(int port, const std::string& method, const std::string& path,
                 const std::string& body) {
  const UniqueFd fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return {};
  const std::string request =
      method + " " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
      "\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body;
  if (::send(fd.get(), request.data(), request.size(), MSG_NOSIGNAL) < 0) return {};
  std::string answer;
  std::array<char, 65536> part;
  while (!is_whole(answer)) {
    const ssize_t size = ::recv(fd.get(), part.data(), part.size(), 0);
    if (size <= 0) return {};
    answer.append(part.data(), static_cast<std::size_t>(size));
  }
  return answer.substr(answer.find("\r\n\r\n") + 4);
}

}  // namespace

bool Browser::is_installed() {
  return std::filesystem::exists(kDriver) && std::filesystem::exists(kBrowser);
}

Browser::Browser(const std::filesystem::path& folder) {
  const std::string output = (folder / "chromedriver.out").string();
  driver_ = std::make_unique<Process>(std::vector<std::string>{kDriver, "--port=0"}, output,
                                      (folder / "chromedriver.log").string());
  const std::regex started("successfully on port ([0-9]+)");
  if (!wait_until(kPatience_s, [&] {
        std::smatch match;
        const std::string said = tools::read_text(output);
        if (std::regex_search(said, match, started)) port_ = std::stoi(match[1]);
        return port_ != 0;
      })) {
    error_ = "chromedriver does not start: " + tools::read_text(output);
    return;
  }
  const json arguments = {"--headless=new", "--no-sandbox",
                          "--disable-gpu",  "--disable-dev-shm-usage",
                          "--no-first-run", "--user-data-dir=" + (folder / "profile").string()};
  const json wanted = {{"browserName", "chrome"},
                       {"goog:loggingPrefs", {{"browser", "ALL"}}},
                       {"goog:chromeOptions", {{"binary", kBrowser}, {"args", arguments}}}};
  const json made = call("POST", "/session", {{"capabilities", {{"alwaysMatch", wanted}}}});
  session_ = made.is_object() ? made.value("sessionId", "") : "";
  if (session_.empty()) error_ = made.dump();
}

Browser::~Browser() {
  if (good()) (void)call("DELETE", "/session/" + session_, json::object());
  driver_->send(SIGTERM);
  (void)driver_->wait(kPatience_s);
}

json Browser::call(const std::string& method, const std::string& path, const json& body) {
  const json answer = json::parse(http(port_, method, path, body.dump()), nullptr, false);
  return answer.is_object() ? answer.value("value", json()) : json();
}

json Browser::ask(const std::string& method, const std::string& path, const json& body) {
  return call(method, "/session/" + session_ + path, body);
}

void Browser::show(int width_px, int height_px, bool phone, bool dark) {
  ask("POST", "/goog/cdp/execute",
      {{"cmd", "Emulation.setDeviceMetricsOverride"},
       {"params",
        {{"width", width_px},
         {"height", height_px},
         {"deviceScaleFactor", phone ? 2 : 1},
         {"mobile", phone}}}});
  const json scheme = {{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}};
  ask("POST", "/goog/cdp/execute",
      {{"cmd", "Emulation.setEmulatedMedia"}, {"params", {{"features", {scheme}}}}});
}

void Browser::open(const std::string& url) {
  ask("POST", "/url", {{"url", url}});
}

json Browser::run(const std::string& script) {
  return ask("POST", "/execute/sync", {{"script", script}, {"args", json::array()}});
}

bool Browser::wait_for(const std::string& condition, double limit_s) {
  return wait_until(limit_s, [&] { return run("return " + condition) == true; });
}

void Browser::press(const std::string& keys) {
  json actions = json::array();
  for (const char key : keys) {
    for (const char* kind : {"keyDown", "keyUp"}) {
      actions.push_back({{"type", kind}, {"value", std::string(1, key)}});
    }
  }
  ask("POST", "/actions",
      {{"actions", {{{"type", "key"}, {"id", "keyboard"}, {"actions", actions}}}}});
}

bool Browser::save_picture(const std::filesystem::path& file) {
  const json text = ask("GET", "/screenshot");
  const auto bytes = text.is_string() ? read_base64(text.get<std::string>()) : std::nullopt;
  if (!bytes) return false;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes->data()),
            static_cast<std::streamsize>(bytes->size()));
  return out.good();
}

std::vector<std::string> Browser::console() {
  std::vector<std::string> lines;
  for (const json& entry : ask("POST", "/se/log", {{"type", "browser"}})) {
    const std::string message = entry.value("message", "");
    if (message.rfind("chrome://", 0) == 0) continue;  // of the browser's own first page
    lines.push_back(entry.value("level", "") + ": " + message);
  }
  return lines;
}

}  // namespace zenith
