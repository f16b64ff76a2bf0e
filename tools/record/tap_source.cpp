// The running daemon's tap.

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "platform/linux/clock.h"
#include "platform/linux/errno_text.h"
#include "platform/linux/local_socket.h"
#include "platform/linux/wait_readable.h"
#include "tools/record/source.h"

namespace zenith::tools {
namespace {

using tap::MessageType;

constexpr Duration kHelloPatience = {5'000'000'000};
// How long the daemon may take to end after it was asked to.
constexpr Duration kEndPatience = {5'000'000'000};

class TapSource final : public RecordSource {
 public:
  TapSource(UniqueFd fd, std::string path) : fd_(std::move(fd)), path_(std::move(path)) {}

  Status begin() {
    const Time limit = monotonic_now() + kHelloPatience;
    while (!has_hello_) {
      const auto more = take(limit - monotonic_now(), nothing_);
      if (!more) return more.error();
      if (!*more) return Error{path_ + ": the daemon hung up before it said anything"};
      if (!has_hello_ && monotonic_now() > limit) {
        return Error{path_ + ": the daemon says nothing; is it stopped?"};
      }
    }
    return {};
  }

  const tap::Hello& robot() const override { return hello_; }
  std::string description() const override {
    return hello_.software + ", robot " + hello_.robot + " (" + path_ + "): " + hello_.devices;
  }
  tap::End end() const override { return end_; }

  Result<bool> take(Duration wait, RecordSink& sink) override {
    if (ended_) return false;
    if (asked_ && monotonic_now() > end_limit_) {
      end_.why = "the daemon did not say how it ended";
      return false;
    }
    const int events = wait_readable(fd_.get(), wait);
    if (events < 0) return Error{path_ + ": " + errno_text(-events)};
    // What is there now, but no more than this: the caller has other business, too.
    constexpr int kReads = 64;
    for (int i = 0; i < kReads && events != 0 && !ended_; ++i) {
      const auto read = read_some();
      if (!read) return read.error();
      if (!*read) break;
      if (const Status handed = hand_on(sink); !handed) return handed.error();
    }
    return !ended_;
  }

  void finish() override {
    if (asked_) return;
    asked_ = true;
    end_limit_ = monotonic_now() + kEndPatience;
    ::shutdown(fd_.get(), SHUT_WR);
  }

 private:
  struct Nothing final : RecordSink {
    void frame(const tap::FrameHead&, ImageView) override {}
    void can(std::span<const CanFrame>) override {}
    void pose(const tap::TappedPose&) override {}
  };

  // One read into the message under way. False when there is nothing now.
  Result<bool> read_some() {
    const bool in_header = header_got_ < tap::kHeaderBytes;
    std::uint8_t* to = in_header ? header_bytes_.data() + header_got_ : body_.data() + body_got_;
    const std::size_t wanted =
        in_header ? tap::kHeaderBytes - header_got_ : body_.size() - body_got_;
    if (wanted == 0) return true;  // a message without fields
    const ssize_t got = ::recv(fd_.get(), to, wanted, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return false;
    if (got <= 0) {
      ended_ = true;
      if (end_.why.empty()) end_.why = "the daemon is gone";
      return false;
    }
    (in_header ? header_got_ : body_got_) += static_cast<std::size_t>(got);
    if (!in_header || header_got_ < tap::kHeaderBytes) return true;
    const auto header = tap::read_header(header_bytes_);
    if (!header) return header.error();
    header_ = *header;
    if (const Status expected = check_header(); !expected) return expected.error();
    body_.resize(header_.length);
    body_got_ = 0;
    return true;
  }

  // Before there is memory for it.
  Status check_header() const {
    const bool begins = header_.type == MessageType::kHello || header_.type == MessageType::kBusy;
    if (has_hello_ ? header_.type == MessageType::kHello : !begins) {
      return Error{path_ + ": nobody there that speaks as zenithd does"};
    }
    const Lens& lens = hello_.config.lens;
    const std::size_t frame = tap::kFrameHeadBytes + static_cast<std::size_t>(lens.width_px) *
                                                         static_cast<std::size_t>(lens.height_px);
    if (header_.type == MessageType::kFrame && header_.length != frame) {
      return Error{path_ + ": a frame of another size than the daemon told"};
    }
    return {};
  }

  // The message, when it is whole.
  Status hand_on(RecordSink& sink) {
    if (header_got_ < tap::kHeaderBytes || body_got_ < body_.size()) return {};
    header_got_ = 0;
    switch (header_.type) {
      case MessageType::kHello: {
        auto hello = tap::read_hello(body_);
        if (!hello) return hello.error();
        hello_ = std::move(*hello);
        has_hello_ = true;
        return {};
      }
      case MessageType::kFrame: {
        std::span<const std::uint8_t> pixels;
        const auto head = tap::read_frame(body_, pixels);
        if (!head) return head.error();
        if (head->width != hello_.config.lens.width_px ||
            head->height != hello_.config.lens.height_px) {
          return Error{path_ + ": a frame of another size than the daemon told"};
        }
        sink.frame(*head, {pixels.data(), head->width, head->height, head->width});
        return {};
      }
      case MessageType::kCan: {
        const Status read = tap::read_can(body_, can_);
        if (read) sink.can(can_);
        return read;
      }
      case MessageType::kPose: {
        const auto pose = tap::read_pose(body_);
        if (!pose) return pose.error();
        sink.pose(*pose);
        return {};
      }
      case MessageType::kEnd: {
        auto end = tap::read_end(body_);
        if (!end) return end.error();
        end_ = std::move(*end);
        ended_ = true;
        return {};
      }
      case MessageType::kBusy:
        return Error{path_ + ": somebody else is recording this robot already"};
    }
    return {};
  }

  UniqueFd fd_;
  const std::string path_;
  Nothing nothing_;
  tap::Hello hello_;
  bool has_hello_ = false;
  bool asked_ = false;
  bool ended_ = false;
  Time end_limit_;
  tap::End end_;

  std::array<std::uint8_t, tap::kHeaderBytes> header_bytes_ = {};
  std::size_t header_got_ = 0;
  tap::Header header_;
  std::vector<std::uint8_t> body_;
  std::size_t body_got_ = 0;
  std::vector<CanFrame> can_;
};

}  // namespace

Result<std::unique_ptr<RecordSource>> open_tap_source(const std::vector<std::string>& paths) {
  std::string tried;
  for (const std::string& path : paths) {
    LocalConnection connection = connect_local(path, SOCK_STREAM);
    if (connection.is_open()) {
      auto source = std::make_unique<TapSource>(std::move(connection.fd), path);
      if (const Status begun = source->begin(); !begun) return begun.error();
      return std::unique_ptr<RecordSource>(std::move(source));
    }
    tried += "\n  " + path + ": " + connection.why;
    if (connection.error == EACCES)
      tried += "; only the daemon's own user and root may record: use sudo";
  }
  return Error{"no running zenithd was found:" + tried +
               "\nStart it (its log tells 'record: PATH'), or name its socket with --socket, or "
               "record from the devices with --config FILE"};
}

}  // namespace zenith::tools
