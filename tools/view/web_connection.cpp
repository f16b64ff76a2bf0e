#include "tools/view/web_connection.h"

#include <algorithm>

namespace zenith::tools {
namespace {

// The page loads nothing from elsewhere, and nobody may put it into a frame.
constexpr std::string_view kGuards =
    "Content-Security-Policy: default-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self' ws: wss:; frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCache-Control: "
    "no-store\r\n";

constexpr std::size_t kPingBytes = 2;
constexpr std::size_t kMostLingering = std::size_t{256} << 10U;

const char* reason_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 426:
      return "Upgrade Required";
    case 431:
      return "Request Header Fields Too Large";
    default:
      return "Service Unavailable";
  }
}

}  // namespace

void WebConnection::receive(std::string_view bytes, Time now) {
  heard_ = now;
  pinged_ = false;
  if (state_ == State::kHead) {
    in_ += bytes;
  } else if (state_ == State::kWebSocket) {
    reader_.feed(bytes);
    has_event_ = true;
  } else if (state_ == State::kLingering) {
    in_.resize(std::min(in_.size() + bytes.size(), kMostLingering));
    if (in_.size() >= kMostLingering) state_ = State::kDone;
  }
}

void WebConnection::sent(std::size_t bytes, Time now) {
  // Who takes what it gets is there; a ping goes into the system's buffer also when nobody is.
  if (out_.size() > kPingBytes) heard_ = now;
  out_.erase(0, bytes);
  flushed_ = now;
  if (!out_.empty() || state_ != State::kFlushing) return;
  state_ = State::kLingering;
  began_ = now;
  in_.clear();
}

bool WebConnection::wants_more(Time now) const {
  if (state_ == State::kDone || state_ == State::kFlushing) return false;
  return state_ != State::kWebSocket || (!has_event_ && out_.empty() && now >= paused_until_);
}

bool WebConnection::has_work(Time now) const {
  return state_ == State::kWebSocket && has_event_ && out_.empty() && now >= paused_until_;
}

void WebConnection::turn(Time now, const std::function<Duration()>& processor_time) {
  const Duration before = processor_time();
  const bool was_empty = out_.empty();
  if (state_ == State::kHead) {
    answer_head(now);
  } else if (has_work(now)) {
    take_event();
  } else if (state_ == State::kWebSocket && out_.empty() && now >= paused_until_) {
    std::vector<WebMessage> messages;
    session_->turn(messages);
    speak(messages);
  }
  // Looking whether there is something to say is no answer: nobody waits for that.
  if (was_empty && !out_.empty()) {
    const std::int64_t cost_ns = processor_time().ns - before.ns;
    paused_until_ = now + std::min(Duration{kPauseFactor * cost_ns}, kMostPause);
  }
  if (was_empty) flushed_ = now;
  // It may still read what it asked for.
  if (input_ended_ && state_ != State::kFlushing) state_ = State::kDone;
  check_limits(now);
}

void WebConnection::answer_head(Time now) {
  ParsedHead parsed = parse_http_head(in_);
  if (parsed.fault == HeadFault::kIncomplete) return;
  WebReply reply;
  if (parsed.fault == HeadFault::kNone) {
    reply = router_(parsed.head);
  } else {
    const bool too_long = parsed.fault == HeadFault::kTooLong;
    fault_ = too_long ? Fault::kTooLong : Fault::kProtocol;
    reply.status = too_long ? 431 : 400;
    reply.content = "This is no request that a browser sends.\n";
  }
  in_.erase(0, parsed.bytes);
  if (reply.session == nullptr) return respond(reply);
  begin_websocket(parsed.head, std::move(reply), now);
}

void WebConnection::begin_websocket(const HttpHead& head, WebReply reply, Time now) {
  const std::string* key = head.header("sec-websocket-key");
  const std::string* version = head.header("sec-websocket-version");
  const bool good = key != nullptr && is_websocket_key(*key) && version != nullptr &&
                    *version == "13" && head.lists("connection", "upgrade");
  if (!good) {
    fault_ = Fault::kProtocol;
    reply.status = 400;
    reply.content = "expected a WebSocket of version 13 (RFC 6455)\n";
    return respond(reply);
  }
  out_ =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Accept: " +
      websocket_accept(*key) + "\r\n";
  if (!reply.protocol.empty()) out_ += "Sec-WebSocket-Protocol: " + reply.protocol + "\r\n";
  out_ += "\r\n";
  session_ = std::move(reply.session);
  state_ = State::kWebSocket;
  reader_.feed(in_);
  has_event_ = !in_.empty();
  in_.clear();
  heard_ = now;
}

void WebConnection::respond(const WebReply& reply) {
  out_ = "HTTP/1.1 " + std::to_string(reply.status) + " " + reason_of(reply.status) +
         "\r\nContent-Type: " + reply.type +
         "\r\nContent-Length: " + std::to_string(reply.content.size()) +
         "\r\nConnection: close\r\n";
  if (reply.status == 401) out_ += "WWW-Authenticate: Bearer\r\n";
  if (reply.status == 405) out_ += "Allow: GET\r\n";
  out_.append(kGuards).append("\r\n").append(reply.content);
  state_ = State::kFlushing;
}

void WebConnection::take_event() {
  WebSocketReader::Event event = reader_.next();
  switch (event.kind) {
    case WebSocketReader::Kind::kNothing:
      has_event_ = false;
      return;
    case WebSocketReader::Kind::kPong:
      return;
    case WebSocketReader::Kind::kPing:
      out_ += websocket_frame(WebOpcode::kPong, event.payload);
      break;
    case WebSocketReader::Kind::kClose:
      close(kCloseNormal);
      break;
    case WebSocketReader::Kind::kFault:
      fault_ = event.close_code == kCloseTooLong ? Fault::kTooLong : Fault::kProtocol;
      close(event.close_code);
      break;
    case WebSocketReader::Kind::kMessage: {
      std::vector<WebMessage> messages;
      const bool good = event.binary || session_->hear(event.payload, messages);
      speak(messages);
      if (!good) {
        fault_ = Fault::kProtocol;
        close(kCloseRefused);
      }
      break;
    }
  }
}

void WebConnection::speak(const std::vector<WebMessage>& messages) {
  for (const WebMessage& message : messages) {
    out_ += websocket_frame(message.binary ? WebOpcode::kBinary : WebOpcode::kText, message.bytes);
  }
}

void WebConnection::close(std::uint16_t code) {
  if (state_ != State::kWebSocket) {
    state_ = State::kDone;
    return;
  }
  out_ += websocket_close(code);
  state_ = State::kFlushing;
}

void WebConnection::end(Fault fault) {
  fault_ = fault;
  state_ = State::kDone;
}

void WebConnection::check_limits(Time now) {
  if (!out_.empty() && now - flushed_ > kIdleLimit) return end(Fault::kSlow);
  switch (state_) {
    case State::kHead:
      if (now - began_ > kHeadLimit) end(Fault::kIdle);
      break;
    case State::kWebSocket:
      if (now - heard_ > kIdleLimit) {
        end(Fault::kIdle);
      } else if (now - heard_ > kPingAfter && !pinged_ && out_.empty()) {
        out_ = websocket_frame(WebOpcode::kPing, "");
        pinged_ = true;
      }
      break;
    case State::kLingering:
      if (now - began_ > kLingerLimit) end(Fault::kNone);
      break;
    case State::kFlushing:
    case State::kDone:
      break;
  }
}

}  // namespace zenith::tools
