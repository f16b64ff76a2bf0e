#pragma once
// The way to other robots: UDP datagrams to a multicast group, to listed addresses, or both.
//
// A group socket only listens, bound to group:port and shared with other programs of this computer;
// the own socket, one for each IP family in use, sends everything and hears what is sent to this
// robot alone. Multicast goes over every interface that is joined, one hop far, and comes back to
// this computer, so that several robots may run on it.
//
// Interfaces may come late, go and come back: refresh() looks again. What cannot be sent is dropped
// and counted; the exchange repeats what matters. No call but wait() waits. One thread at a time,
// none with deadlines.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/radio/interfaces.h"
#include "platform/base/endpoint.h"
#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

struct RadioSettings {
  std::string group = "239.255.90.78";  // or an IPv6 group; empty: none
  int port = 21473;                     // of the group
  int own_port = 21474;                 // 0: any that is free
  std::string interface;                // by name; empty: all
  std::string peers;                    // addresses, with commas between them
};

// What is wrong with them; parse() of the texts.
Status check(const RadioSettings& settings);

struct RadioDatagram {
  Endpoint from;
  std::span<const std::uint8_t> bytes;
};

struct RadioCounters {
  std::uint64_t sent = 0;  // datagrams, each copy of one
  std::uint64_t received = 0;
  std::uint64_t too_long = 0;     // received ones that were cut: not ours
  std::uint64_t dropped = 0;      // by the kernel, its queue being full
  std::uint64_t unreachable = 0;  // no network, no route, no address
  std::uint64_t no_buffer = 0;    // the kernel's queue for sending was full
  std::uint64_t forbidden = 0;    // by a firewall or the service's sandbox
  std::uint64_t not_sent = 0;     // for another reason
  std::uint64_t joins = 0;
};

class UdpRadio {
 public:
  static constexpr std::size_t kBatch = 32;
  static constexpr std::size_t kMaxBytes = 1200;
  static constexpr std::size_t kMaxInterfaces = 8;
  static constexpr int kGoodAgain = 50;  // datagrams sent in a row, after a failure

  // `settings` were checked.
  explicit UdpRadio(const RadioSettings& settings);
  UdpRadio(const UdpRadio&) = delete;
  UdpRadio& operator=(const UdpRadio&) = delete;
  ~UdpRadio();

  // An error when a port is taken or sockets are not allowed. That no interface is there is none.
  Status open();
  void close();
  bool is_open() const { return own_[0].is_open() || own_[1].is_open(); }

  // Every second or two: joins the group where it is not joined, looks up interfaces of listed
  // addresses.
  void refresh();

  // Until something can be received, at most `timeout`; closed, it sleeps.
  void wait(Duration timeout);
  // A batch of what has come; empty when there is nothing more. Valid until the next call.
  std::span<const RadioDatagram> receive();

  void send(const Endpoint& to, std::span<const std::uint8_t> bytes);
  void send_to_everybody(std::span<const std::uint8_t> bytes);
  // How many datagrams that is on one network.
  int copies_to_everybody() const;

  std::uint16_t own_port() const { return own_port_; }
  const RadioCounters& counters() const { return counters_; }
  // Where multicast goes, for the log: "wlan0, eth0"; empty: nowhere.
  std::string joined_text() const;
  // What is new about sending, once for each change: "cannot send: ...". False: nothing.
  bool next_news(std::string& out);

 private:
  struct Batch;  // the kernel's structures for kBatch datagrams
  static constexpr std::size_t kIpv4 = 0;
  static constexpr std::size_t kIpv6 = 1;

  Status open_own(std::size_t family);
  Status open_group();
  bool join(const Interface& interface);
  void note_drops(std::size_t socket, std::uint32_t sum);
  std::size_t receive_from(std::size_t socket);
  void send_on(const Endpoint& to, std::uint32_t interface, std::span<const std::uint8_t> bytes);
  void note_sent(int error);

  const RadioSettings settings_;
  Endpoint group_;
  bool has_group_ = false;
  std::vector<Endpoint> peers_;
  std::array<UniqueFd, 2> own_;
  UniqueFd group_socket_;
  std::uint16_t own_port_ = 0;
  std::vector<Interface> joined_;

  std::unique_ptr<Batch> batch_;
  std::array<RadioDatagram, kBatch> received_;
  std::size_t next_socket_ = 0;
  std::array<std::uint32_t, 3> drops_seen_ = {};
  RadioCounters counters_;
  int trouble_ = 0;  // errno of the last failure; 0 when kGoodAgain were sent since
  int told_ = 0;
  int sent_in_a_row_ = 0;
};

}  // namespace zenith
