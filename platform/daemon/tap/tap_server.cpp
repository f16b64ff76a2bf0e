#include "platform/daemon/tap/tap_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "platform/linux/clock.h"
#include "platform/linux/log.h"

namespace zenith::tap {
namespace {

// How often a recorder's frames are looked for, and a new recorder.
constexpr Duration kLook = {5'000'000};
constexpr Duration kIdleLook = {100'000'000};
// Whoever connects again and again costs no more than this many rounds a second.
constexpr Duration kAcceptPause = {20'000'000};
constexpr Duration kFarewell = {300'000'000};

unsigned long long number(std::uint64_t value) {
  return static_cast<unsigned long long>(value);
}

}  // namespace

TapServer::TapServer(Tap& tap, const Hello& hello) : tap_(tap), hello_(write_hello(hello)) {}

Status TapServer::open(const std::string& path) {
  close();
  if (hello_.empty()) return Error{"record socket " + path + ": the base's DBC file is too long"};
  constexpr unsigned kOwnerAlone = 0600;
  constexpr int kBacklog = 4;
  auto made = listen_local(path, SOCK_STREAM, kOwnerAlone, kBacklog);
  if (!made) return Error{"record socket " + path + ": " + made.error().message};
  listener_ = std::move(*made);
  return {};
}

void TapServer::close() {
  tap_.stop();
  recorder_.reset();
  listener_.close();
}

void TapServer::run(const std::atomic<bool>& stop) {
  while (!stop.load(std::memory_order_relaxed)) turn(recording() ? kLook : kIdleLook);
  if (!recording()) return;
  ask_end("the daemon ends");
  const Time limit = monotonic_now() + kFarewell;
  while (recording() && monotonic_now() < limit) turn(kLook);
}

void TapServer::turn(Duration wait_at_most) {
  wait(wait_at_most);
  if (recording()) pump();
}

// Waits for a recorder that takes more, wants to end, has left, or comes.
void TapServer::wait(Duration longest) {
  std::array<pollfd, 2> entries = {};
  const bool accepts = listener_.is_open() && monotonic_now() >= next_accept_;
  entries[0] = {accepts ? listener_.fd() : -1, POLLIN, 0};
  short events = 0;
  if (!ending_) events = POLLIN;
  if (blocked_) events = static_cast<short>(events | POLLOUT);
  entries[1] = {recording() ? recorder_.get() : -1, events, 0};
  const int ready = ::poll(entries.data(), entries.size(),
                           static_cast<int>(std::max<std::int64_t>(longest.ns / 1'000'000, 0)));
  if (ready <= 0) return;
  if ((entries[1].revents & (POLLERR | POLLHUP)) != 0) {
    forget("it is gone");
  } else if ((entries[1].revents & POLLIN) != 0) {
    ask_end("as asked");  // it has shut its side down, or says what nobody asked for
  }
  if ((entries[0].revents & POLLIN) != 0) accept_one();
}

bool TapServer::is_ours(int fd) const {
  ucred peer = {};
  socklen_t size = sizeof(peer);
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  return peer.uid == 0 || peer.uid == ::geteuid();
}

void TapServer::accept_one() {
  next_accept_ = monotonic_now() + kAcceptPause;
  UniqueFd fd(::accept4(listener_.fd(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!fd.is_open() || !is_ours(fd.get())) return;
  if (recording()) {
    turn_away(std::move(fd));
  } else {
    begin(std::move(fd));
  }
}

void TapServer::turn_away(UniqueFd fd) {
  std::array<std::uint8_t, kHeaderBytes> busy;
  const std::size_t size = write_busy(busy);
  (void)::send(fd.get(), busy.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

void TapServer::begin(UniqueFd fd) {
  recorder_ = std::move(fd);
  alive_ = monotonic_now();
  blocked_ = ending_ = end_written_ = false;
  end_ = {};
  head_ = hello_;
  body_ = {};
  tap_.start();
  log_line(LogLevel::kInfo, "a recorder listens to the tap");
}

void TapServer::ask_end(const char* why) {
  if (ending_) return;
  tap_.stop();
  ending_ = true;
  end_.why = why;
}

void TapServer::forget(const char* why) {
  tap_.stop();
  if (holds_frame_) tap_.give_back(frame_);
  holds_frame_ = false;
  recorder_.reset();
  const Drops drops = tap_.drops();
  log_line(LogLevel::kInfo, "the recorder has ended (%s): %llu frames, %llu more dropped", why,
           number(end_.frames), number(drops.frames));
}

void TapServer::pump() {
  // A recorder that takes all at once does not keep this thread from its other business.
  constexpr int kMessages = 64;
  for (int i = 0; i < kMessages; ++i) {
    switch (send_rest()) {
      case Sent::kGone:
        return forget("it is gone");
      case Sent::kBlocked:
        if (monotonic_now() - alive_ > kPatience) forget("it took nothing for too long");
        return;
      case Sent::kAll:
        break;
    }
    if (next_message()) continue;
    alive_ = monotonic_now();  // nothing to take is no fault of its
    if (end_written_) forget(end_.why.c_str());
    return;
  }
}

// Fills head_ and body_ with what comes next; false when there is nothing.
bool TapServer::next_message() {
  if (holds_frame_) tap_.give_back(frame_);
  holds_frame_ = false;
  head_ = body_ = {};
  if (end_written_) return false;
  if (next_can()) return true;
  TappedPose pose;
  if (tap_.next(pose)) {
    head_ = std::span(head_room_).first(write_pose(pose, head_room_));
    ++end_.poses;
    return true;
  }
  if (tap_.next(frame_)) {
    holds_frame_ = true;
    head_ = std::span(head_room_).first(write_frame_head(frame_.head, head_room_));
    body_ = {frame_.pixels, static_cast<std::size_t>(frame_.head.width) *
                                static_cast<std::size_t>(frame_.head.height)};
    ++end_.frames;
    return true;
  }
  if (!ending_) return false;
  const Drops drops = tap_.drops();
  end_.frames_dropped = drops.frames;
  end_.can_dropped = drops.can;
  end_.poses_dropped = drops.poses;
  head_ = std::span(head_room_).first(write_end(end_, head_room_));
  end_written_ = true;
  return true;
}

bool TapServer::next_can() {
  std::array<CanFrame, 64> frames;
  static_assert(kHeaderBytes + frames.size() * kCanBytes <= sizeof(head_room_));
  std::size_t count = 0;
  while (count < frames.size() && tap_.next(frames[count])) ++count;
  if (count == 0) return false;
  head_ = std::span(head_room_).first(write_can(std::span(frames).first(count), head_room_));
  end_.can += count;
  return true;
}

TapServer::Sent TapServer::send_rest() {
  blocked_ = false;
  while (!head_.empty() || !body_.empty()) {
    std::array<iovec, 2> pieces;
    pieces[0] = {const_cast<std::uint8_t*>(head_.data()), head_.size()};
    pieces[1] = {const_cast<std::uint8_t*>(body_.data()), body_.size()};
    msghdr message = {};
    message.msg_iov = pieces.data();
    message.msg_iovlen = pieces.size();
    const ssize_t sent = ::sendmsg(recorder_.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS)) {
      blocked_ = true;
      return Sent::kBlocked;
    }
    if (sent <= 0) return Sent::kGone;
    alive_ = monotonic_now();
    const std::size_t of_head = std::min(static_cast<std::size_t>(sent), head_.size());
    head_ = head_.subspan(of_head);
    body_ = body_.subspan(static_cast<std::size_t>(sent) - of_head);
  }
  return Sent::kAll;
}

}  // namespace zenith::tap
