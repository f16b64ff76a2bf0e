#pragma once
// One connection of the page's server, without a socket and without a clock: bytes in, bytes out.
//
// Bounded whatever comes: a head of 8 kB within ten seconds, a message of 64 kB, one answer on its
// way at a time; who says nothing for half a minute or does not take what it asked for is cut off,
// and who asks for much waits between answers.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/time.h"
#include "tools/view/http_head.h"
#include "tools/view/websocket.h"

namespace zenith::tools {

struct WebMessage {
  bool binary = false;
  std::string bytes;
};

// What speaks over a WebSocket.
class WebSession {
 public:
  virtual ~WebSession() = default;
  // A text of the client; false: it does not speak as it should, and is cut off.
  virtual bool hear(std::string_view text, std::vector<WebMessage>& out) = 0;
  // Nothing waits to be sent: what else there is to say now.
  virtual void turn(std::vector<WebMessage>& out) = 0;
};

struct WebReply {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string content;
  // Then it is a WebSocket, with this subprotocol (or none).
  std::unique_ptr<WebSession> session;
  std::string protocol;
};
using WebRouter = std::function<WebReply(const HttpHead&)>;

class WebConnection {
 public:
  static constexpr Duration kHeadLimit = {10'000'000'000};   // until the head is whole
  static constexpr Duration kPingAfter = {15'000'000'000};   // of silence
  static constexpr Duration kIdleLimit = {30'000'000'000};   // silence, or nothing taken
  static constexpr Duration kLingerLimit = {2'000'000'000};  // after the answer
  // After an answer that took so much of the processor's time the next one waits this many times as
  // long, but no longer than kMostPause.
  static constexpr int kPauseFactor = 15;
  static constexpr Duration kMostPause = {2'000'000'000};

  enum class State { kHead, kWebSocket, kFlushing, kLingering, kDone };
  // Why it ended, where somebody should be told.
  enum class Fault { kNone, kTooLong, kProtocol, kSlow, kIdle };

  WebConnection(const WebRouter& router, Time now) : router_(router), began_(now), heard_(now) {}

  // What was received.
  void receive(std::string_view bytes, Time now);
  // The other side sends no more.
  void end_of_input() { input_ended_ = true; }
  // Answers at most one request or message of what was received, and looks at the limits.
  // `processor_time` is called before and after the work.
  void turn(Time now, const std::function<Duration()>& processor_time);
  // So much of out() was sent.
  void sent(std::size_t bytes, Time now);
  // As soon as all was sent, it ends.
  void close(std::uint16_t code);
  // The socket is broken.
  void abandon() { state_ = State::kDone; }

  const std::string& out() const { return out_; }
  State state() const { return state_; }
  Fault fault() const { return fault_; }
  // Whether more should be received, and whether turn() has something to do without that.
  bool wants_more(Time now) const;
  bool has_work(Time now) const;

 private:
  void answer_head(Time now);
  void begin_websocket(const HttpHead& head, WebReply reply, Time now);
  void respond(const WebReply& reply);
  void take_event();
  void speak(const std::vector<WebMessage>& messages);
  void end(Fault fault);
  void check_limits(Time now);

  const WebRouter& router_;
  State state_ = State::kHead;
  Fault fault_ = Fault::kNone;
  std::string in_;
  std::string out_;
  WebSocketReader reader_;
  std::unique_ptr<WebSession> session_;
  bool has_event_ = false;  // the reader may have another message
  bool pinged_ = false;
  bool input_ended_ = false;
  Time began_;
  Time heard_;
  Time flushed_;  // when something was last taken of out_
  Time paused_until_;
};

}  // namespace zenith::tools
