#pragma once
// Tells the service manager how we are: the sd_notify protocol (man sd_notify), without its
// library.
//
// Without NOTIFY_SOCKET in the environment every call succeeds and does nothing. No call blocks or
// allocates, except to make an error; one thread at a time.

#include <optional>
#include <string_view>

#include "platform/base/result.h"
#include "platform/base/time.h"
#include "platform/linux/unique_fd.h"

namespace zenith {

class ServiceNotify {
 public:
  // Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID. After an error the object does nothing,
  // like one without a service manager.
  Status open_from_environment();
  bool connected() const { return socket_.is_open(); }

  // Started, or done with reloading. When this fails, try again: the manager waits for it.
  Status ready();
  // Before a reload; ready() after it. `now` on CLOCK_MONOTONIC.
  Status reloading(Time now);
  Status stopping();
  // Starting or stopping takes so much longer from now on, whatever the unit's time-out is. Again
  // before that is over.
  Status extend_timeout(Duration time);
  // One line that `systemctl status` shows. Cut after 200 bytes; line ends become spaces.
  Status status(std::string_view text);
  // Alive. Call when the loop made progress, at least twice in each watchdog interval.
  Status watchdog();

  // After this time without watchdog() the manager ends us. Nothing when it does not watch.
  std::optional<Duration> watchdog_interval() const { return watchdog_interval_; }

 private:
  Status send(std::string_view message);

  UniqueFd socket_;
  std::optional<Duration> watchdog_interval_;
};

}  // namespace zenith
