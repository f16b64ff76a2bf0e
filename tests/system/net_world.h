#pragma once
// A small network of its own: computers (network namespaces) on one switch (a bridge), whose cables
// can be pulled. Needs root and the ip command; everything goes away with the object.

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <thread>

#include "platform/linux/unique_fd.h"

namespace zenith {

class NetWorld {
 public:
  explicit NetWorld(int computers) : prefix_("zt" + std::to_string(::getpid()) + "-") {
    good_ = ::geteuid() == 0 && ip("netns add " + switch_name()) &&
            on_switch("link add br0 type bridge mcast_snooping 0") && on_switch("link set br0 up");
    for (int i = 1; good_ && i <= computers; ++i) good_ = add(i);
  }
  ~NetWorld() {
    for (int i = 1; i <= count_; ++i) (void)ip("netns del " + name(i));
    (void)ip("netns del " + switch_name());
  }
  NetWorld(const NetWorld&) = delete;
  NetWorld& operator=(const NetWorld&) = delete;

  // False: not permitted here.
  bool good() const { return good_; }

  // Computers count from 1; their address is 10.77.0.N.
  std::string name(int computer) const { return prefix_ + std::to_string(computer); }
  static std::string address(int computer) { return "10.77.0." + std::to_string(computer); }
  bool pull_cable(int computer) const { return on_switch("link set " + port(computer) + " down"); }
  bool plug_cable(int computer) const { return on_switch("link set " + port(computer) + " up"); }

  // Runs `work` on a computer: sockets that it opens stay there. Its network is wlan0.
  template <typename Work>
  bool on(int computer, Work work) const {
    return in(name(computer), work);
  }
  // Likewise on the switch, where all cables end.
  template <typename Work>
  bool on_the_switch(Work work) const {
    return in(switch_name(), work);
  }

 private:
  template <typename Work>
  static bool in(const std::string& netns, Work work) {
    bool entered = false;
    std::thread([&] {
      const UniqueFd fd(::open(("/run/netns/" + netns).c_str(), O_RDONLY | O_CLOEXEC));
      entered = fd.is_open() && ::setns(fd.get(), CLONE_NEWNET) == 0;
      if (entered) work();
    }).join();
    return entered;
  }
  static bool ip(const std::string& words) {
    return std::system(("ip " + words + " >/dev/null 2>&1").c_str()) == 0;
  }
  static std::string port(int computer) { return "port" + std::to_string(computer); }
  std::string switch_name() const { return prefix_ + "switch"; }
  bool on_switch(const std::string& words) const { return ip("-n " + switch_name() + " " + words); }

  bool add(int i) {
    count_ = i;
    const std::string here = "-n " + name(i) + " ";
    return ip("netns add " + name(i)) &&
           on_switch("link add " + port(i) + " type veth peer name wlan0 netns " + name(i)) &&
           on_switch("link set " + port(i) + " master br0 up") &&
           ip(here + "address add " + address(i) + "/24 dev wlan0") &&
           ip(here + "link set wlan0 up") && ip(here + "link set lo up");
  }

  const std::string prefix_;
  int count_ = 0;
  bool good_ = false;
};

}  // namespace zenith
