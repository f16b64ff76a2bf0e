#include "tools/doctor/check_daemon.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <map>

#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/wait_readable.h"
#include "slam/watch/verdict.h"
#include "tools/record/source.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {
namespace {

constexpr std::size_t kMostLines = 2000;  // of one asking

// A number of a line, whatever else it may be.
double number(const TelemetryLine& line, const char* path) {
  return line.number(path).value_or(0.0);
}

std::string text(const TelemetryLine& line, const char* path) {
  std::string found = line.text(path);
  return found.empty() ? "?" : found;
}

std::string whole(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.0f", value);
  return digits;
}

// The last line of each type; what is no line of telemetry is passed over.
std::map<std::string, TelemetryLine> by_type(const std::vector<std::string>& lines) {
  std::map<std::string, TelemetryLine> found;
  for (const std::string& line : lines) {
    DecodedLine decoded = decode_telemetry(line);
    if (decoded.line) found[decoded.line->type()] = std::move(*decoded.line);
  }
  return found;
}

Finding check_health(const TelemetryLine& health) {
  const std::string what = "daemon state";
  const std::string state = text(health, "/state");
  const std::string reason = text(health, "/reason");
  const std::string found = state + (reason.empty() || reason == "?" ? "" : ": " + reason);
  if (state == "mapping" || state == "merged") return ok(what, found);
  if (state == "fault")
    return fail(what, found, "its log says more", "journalctl -u zenithd -n 50");
  return warn(what, found, "its log says more", "journalctl -u zenithd -n 50");
}

// A line for each reason of the verdict on camera, wheels and clocks.
Findings check_setup(const TelemetryLine& verdict) {
  const std::string what = "set-up";
  const auto reasons = verdict.shown().find("reasons");
  Findings findings;
  if (reasons != verdict.shown().end() && reasons->is_object()) {
    for (const auto& [code, reason] : reasons->items()) {
      const std::string at = "/reasons/" + code;
      const std::string advice = text(verdict, (at + "/text").c_str());
      if (code == setup_code_name(SetupCode::kNotJudgedYet)) {
        findings.push_back(skip(what, advice));
      } else if (text(verdict, (at + "/severity").c_str()) == verdict_name(VerdictState::kWrong)) {
        findings.push_back(fail(what, code, advice));
      } else {
        findings.push_back(warn(what, code, advice));
      }
    }
  }
  if (findings.empty()) findings.push_back(ok(what, "camera, wheels and their clocks agree"));
  return findings;
}

Finding check_devices(const TelemetryLine& health) {
  const std::string what = "daemon devices";
  const bool camera = number(health, "/camera/up") != 0.0;
  const bool can = number(health, "/can/up") != 0.0;
  std::string found = std::string("camera ") + (camera ? "up" : "down") + ", " +
                      whole(number(health, "/camera/frames")) + " frames; CAN bus " +
                      (can ? "up" : "down") + ", " + whole(number(health, "/wheels/samples")) +
                      " samples of the wheels";
  const double lost = number(health, "/camera/lost") + number(health, "/can/lost");
  if (!camera || !can) return fail(what, found, "see the lines about this device");
  if (lost > 0.0) {
    return warn(what, found + "; lost and opened again " + whole(lost) + " times",
                "look at cables and supply", "sudo dmesg | tail -30");
  }
  return ok(what, found);
}

Finding check_deadlines(const TelemetryLine& deadlines) {
  const std::string what = "daemon deadlines";
  const double met = number(deadlines, "/met");
  const double missed = number(deadlines, "/missed");
  const double own = missed - number(deadlines, "/explained");
  const std::string found = whole(missed) + " of " + whole(met + missed) +
                            " frames late, of these for want of a CPU " + whole(missed - own);
  if (missed <= 0.01 * (met + missed)) return ok(what, found);
  if (own > 0.5 * missed) {
    return warn(what, found, "this computer is too slow: a lower camera.rate_hz, fewer particles");
  }
  return warn(what, found, "other programs take its CPU: see the lines about realtime");
}

Finding check_peers(const std::map<std::string, TelemetryLine>& lines) {
  const std::string what = "daemon peers";
  const auto line = lines.find("radio");
  if (line == lines.end()) return skip(what, "it tells nothing of a radio");
  const TelemetryLine& radio = line->second;
  if (number(radio, "/enabled") == 0.0) return ok(what, "no radio: this robot maps alone");
  if (number(radio, "/open") == 0.0) {
    return fail(what, "the radio is not open", "a port is taken, or sockets are not allowed",
                "journalctl -u zenithd -n 50");
  }
  const double heard = number(radio, "/peers");
  const double other_key = number(radio, "/rejected/other_key");
  const std::string found = whole(heard) + " peers, " + whole(number(radio, "/udp/received")) +
                            " datagrams received, " + whole(number(radio, "/udp/sent")) + " sent";
  if (number(radio, "/udp/forbidden") > 0.0) {
    return warn(what, found + ", some are forbidden", "a firewall stops them: open radio.port");
  }
  if (heard == 0.0 && other_key > 0.0) {
    return warn(what, found + ", others have another key", "copy one key file to all robots");
  }
  return ok(what, found);
}

}  // namespace

DaemonFacts ask_daemon(const DaemonConfig& config, Duration patience) {
  DaemonFacts facts;
  UniqueFd fd;
  for (const std::string& path : runtime_paths(config.telemetry.socket)) {
    if (facts.path.empty()) facts.path = path;
    LocalConnection connection = connect_local(path, SOCK_SEQPACKET);
    facts.pid = connection.pid;
    fd = std::move(connection.fd);
    if (fd.is_open()) {
      facts.path = path;
      break;
    }
    facts.untrusted = facts.untrusted || connection.error == EPERM;
    if (!connection.absent()) facts.problem = path + ": " + connection.why;
  }
  if (!fd.is_open()) return facts;
  facts.running = true;
  const Time limit = monotonic_now() + patience;
  bool health = false;
  bool deadlines = false;
  bool radio = false;
  while (monotonic_now() < limit && !(health && deadlines && radio) &&
         facts.lines.size() < kMostLines) {
    if (wait_readable(fd.get(), limit - monotonic_now()) <= 0) break;
    std::array<char, 8192> packet;
    const ssize_t size = ::recv(fd.get(), packet.data(), packet.size(), MSG_DONTWAIT);
    if (size <= 0) break;
    facts.lines.emplace_back(packet.data(), static_cast<std::size_t>(size));
    health = health || facts.lines.back().find("\"type\":\"health\"") != std::string::npos;
    radio = radio || facts.lines.back().find("\"type\":\"radio\"") != std::string::npos;
    deadlines = deadlines || facts.lines.back().find("\"type\":\"deadlines\"") != std::string::npos;
  }
  return facts;
}

Findings check_daemon(const DaemonFacts& facts) {
  const std::string what = "daemon";
  if (!facts.running && facts.untrusted) {
    return {warn(what, facts.problem, "nothing was asked there: see whose socket that is")};
  }
  if (!facts.running && !facts.problem.empty()) {
    return {warn(what, facts.problem, "it cannot be asked by this user, or hangs: use sudo")};
  }
  if (!facts.running) return {skip(what, "none is running (nobody listens at " + facts.path + ")")};
  const auto lines = by_type(facts.lines);
  if (lines.empty()) {
    return {fail(what, "it listens at " + facts.path + " and says nothing",
                 "it hangs, or has more readers than it takes", "journalctl -u zenithd -n 50")};
  }
  std::string found = "running";
  if (const auto hello = lines.find("hello"); hello != lines.end()) {
    found += ", robot " + text(hello->second, "/robot") + ", version " +
             text(hello->second, "/version") + "; " + text(hello->second, "/devices");
  }
  Findings findings = {ok(what, found)};
  const auto health = lines.find("health");
  if (health == lines.end()) {
    findings.push_back(fail("daemon state", "it tells none", "its main thread hangs",
                            "journalctl -u zenithd -n 50"));
    return findings;
  }
  findings.push_back(check_health(health->second));
  findings.push_back(check_devices(health->second));
  if (const auto verdict = lines.find("verdict"); verdict != lines.end()) {
    append(findings, check_setup(verdict->second));
  }
  if (const auto deadlines = lines.find("deadlines"); deadlines != lines.end()) {
    findings.push_back(check_deadlines(deadlines->second));
  }
  findings.push_back(check_peers(lines));
  return findings;
}

}  // namespace zenith::tools
