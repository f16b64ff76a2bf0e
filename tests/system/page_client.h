#pragma once
// A program that speaks with the page's server: HTTP and WebSocket, over a socket.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "platform/linux/unique_fd.h"
#include "tests/support/patience.h"

namespace zenith {

// A client as small as can be.
class PageClient {
 public:
  // `token`: of the address that `zenith view` printed.
  explicit PageClient(int port, std::string token = "")
      : token_(std::move(token)), fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience = {static_cast<time_t>(kPatience_s), 0};
    ::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(fd_.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    (void)::connect(fd_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address);
  }

  void send(const std::string& bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t size =
          ::send(fd_.get(), bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (size <= 0) return;
      done += static_cast<std::size_t>(size);
    }
  }
  // The head of the answer; what follows stays.
  std::string head() {
    std::string text;
    while (text.find("\r\n\r\n") == std::string::npos && more(1)) text += take(1);
    return text;
  }
  std::string rest() {
    while (more(rest_.size() + 1)) {
    }
    return std::move(rest_);
  }

  // --- WebSocket
  std::string upgrade(const std::string& path, const std::string& more_headers) {
    send("GET " + path + (token_.empty() ? "" : "?token=" + token_) +
         " HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: "
         "Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
         "dGhlIHNhbXBsZSBub25jZQ==\r\n" +
         more_headers + "\r\n");
    return head();
  }
  // Masked, as clients must, with zeros.
  void say(const nlohmann::json& message) { say_text(message.dump()); }
  void say_text(const std::string& text) {
    std::string frame = {'\x81', static_cast<char>(0x80 | 127)};
    for (unsigned shift = 64; shift > 0; shift -= 8) {
      frame += static_cast<char>(text.size() >> (shift - 8));
    }
    send(frame + std::string(4, '\0') + text);
  }
  struct Message {
    int opcode = 0;
    std::string bytes;
  };
  // Opcode 0: none came.
  Message hear() {
    if (!more(2)) return {};
    const std::string first = take(2);
    std::size_t size = first[1] & 0x7f;
    const std::size_t length = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (length > 0) {
      if (!more(length)) return {};
      size = 0;
      for (const char c : take(length)) size = size << 8 | static_cast<unsigned char>(c);
    }
    if (!more(size)) return {};
    return {first[0] & 0xf, take(size)};
  }

  // One question of a page and its answer; null when none comes.
  nlohmann::json ask(const nlohmann::json& request) {
    say(request);
    return nlohmann::json::parse(hear().bytes, nullptr, false);
  }

 private:
  bool more(std::size_t size) {
    std::array<char, 65536> part;
    while (rest_.size() < size) {
      const ssize_t got = ::recv(fd_.get(), part.data(), part.size(), 0);
      if (got <= 0) return false;
      rest_.append(part.data(), static_cast<std::size_t>(got));
    }
    return true;
  }
  std::string take(std::size_t size) {
    std::string piece = rest_.substr(0, size);
    rest_.erase(0, size);
    return piece;
  }

  const std::string token_;
  UniqueFd fd_;
  std::string rest_;
};

}  // namespace zenith
