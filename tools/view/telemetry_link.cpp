#include "tools/view/telemetry_link.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>

#include "platform/linux/errno_text.h"
#include "platform/linux/local_socket.h"
#include "tools/view/telemetry_line.h"

namespace zenith::tools {
namespace {

constexpr Duration kTryAgain = {1'000'000'000};
constexpr const char* kUsualSocket = "telemetry.sock";
constexpr std::string_view kSsh = "ssh:";

}  // namespace

Result<RobotAddress> parse_robot_address(const std::string& text) {
  RobotAddress address;
  address.text = text;
  std::string path = text;
  if (text.compare(0, kSsh.size(), kSsh) == 0) {
    const std::size_t colon = text.find(':', kSsh.size());
    address.host = text.substr(kSsh.size(), colon - kSsh.size());
    path = colon == std::string::npos ? "" : text.substr(colon + 1);
    // ssh would take it for an option; a shell on the other side reads the path.
    const bool good = !address.host.empty() && address.host[0] != '-' &&
                      path.find_first_of(" '\"\\$`;&|<>()\n") == std::string::npos;
    if (!good) {
      return Error{
          "expected a robot such as ssh:anna or ssh:user@anna:/run/zenith/telemetry.sock, "
          "found '" +
          text + "'"};
    }
  }
  if (!path.empty()) {
    address.paths = path.find('/') == std::string::npos && address.host.empty()
                        ? runtime_paths(path)
                        : std::vector<std::string>{path};
  } else if (address.host.empty()) {
    address.paths = runtime_paths(kUsualSocket);
  }
  return address;
}

Result<std::vector<RobotAddress>> parse_robot_addresses(const std::vector<std::string>& texts) {
  if (texts.size() > kMostRobots) {
    return Error{"expected at most " + std::to_string(kMostRobots) + " robots, found " +
                 std::to_string(texts.size())};
  }
  std::vector<RobotAddress> robots;
  for (const std::string& text : texts) {
    auto address = parse_robot_address(text);
    if (!address) return address.error();
    robots.push_back(std::move(*address));
  }
  return robots;
}

TelemetryLink::TelemetryLink(RobotAddress address)
    : address_(std::move(address)), why_("not connected yet") {}

void TelemetryLink::open() {
  rest_.clear();
  if (address_.host.empty()) {
    open_local();
  } else {
    open_ssh();
  }
}

void TelemetryLink::open_local() {
  std::string tried;
  for (const std::string& path : address_.paths) {
    LocalConnection connection = connect_local(path, SOCK_SEQPACKET);
    fd_ = std::move(connection.fd);
    if (fd_.is_open()) return;
    tried += (tried.empty() ? "" : "; ") + path + ": " + connection.why;
  }
  why_ = "no daemon's telemetry (" + tried + ")";
}

// Its lines and what it is asked go through one socket, its standard input and output.
void TelemetryLink::open_ssh() {
  std::array<int, 2> ends = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    why_ = errno_text(errno);
    return;
  }
  fd_ = UniqueFd(ends[0]);
  const UniqueFd theirs(ends[1]);
  std::vector<std::string> words = {"ssh", "-o", "BatchMode=yes", "-o",     "ServerAliveInterval=5",
                                    "-C",  "--", address_.host,   "zenith", "telemetry"};
  if (!address_.paths.empty()) words.push_back(address_.paths[0]);
  auto started = ChildProcess::start_talking(words, theirs.get());
  if (!started) {
    fd_.reset();
    why_ = started.error().message;
    return;
  }
  ssh_ = std::make_unique<ChildProcess>(std::move(*started));
}

void TelemetryLink::close(std::string why) {
  fd_.reset();
  ssh_.reset();
  up_ = false;
  why_ = std::move(why);
}

bool TelemetryLink::turn(Time now, const std::function<void(std::string_view)>& take) {
  const bool was_up = up_;
  const std::string why = why_;
  if (!fd_.is_open()) {
    if (now < next_try_) return false;
    next_try_ = now + kTryAgain;
    open();
  }
  // What is there now, but no more than this: others have their turn, too.
  constexpr int kReads = 256;
  for (int i = 0; i < kReads && fd_.is_open() && read(take); ++i) {
  }
  return up_ != was_up || why_ != why;
}

// False when there is nothing now.
bool TelemetryLink::read(const std::function<void(std::string_view)>& take) {
  std::array<char, 65536> text;
  const ssize_t size = ::recv(fd_.get(), text.data(), text.size(), MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return false;
  if (size <= 0) {
    const bool said = up_ || address_.host.empty();
    close(said ? "the daemon has left"
               : "ssh " + address_.host + " zenith telemetry: ended; try it in a shell");
    return false;
  }
  rest_.append(text.data(), static_cast<std::size_t>(size));
  std::size_t begin = 0;
  for (std::size_t end = rest_.find('\n'); end != std::string::npos;
       end = rest_.find('\n', begin)) {
    up_ = true;
    why_.clear();
    take(std::string_view(rest_).substr(begin, end - begin));
    begin = end + 1;
  }
  rest_.erase(0, begin);
  if (rest_.size() > kLongestLine) close("what comes is no telemetry");
  return fd_.is_open();
}

void TelemetryLink::ask_picture() {
  constexpr std::string_view kRequest = "picture\n";
  if (up_) (void)::send(fd_.get(), kRequest.data(), kRequest.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace zenith::tools
