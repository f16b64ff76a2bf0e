#pragma once
// Which of a sender's counters were seen: the newest 1024 are known one by one (as in IPsec,
// RFC 4303 3.4.3, and WireGuard); what is older counts as seen.

#include <array>
#include <cstddef>
#include <cstdint>

namespace zenith {

class ReplayWindow {
 public:
  static constexpr std::uint64_t kWidth = 1024;

  // Nothing up to and including `counter` is new.
  void begin(std::uint64_t counter) {
    newest_ = counter;
    seen_.fill(~std::uint64_t{0});
  }

  bool is_new(std::uint64_t counter) const {
    if (counter > newest_) return true;
    return newest_ - counter < kWidth && (word(counter) & bit(counter)) == 0;
  }

  // A counter that is_new(). Only for datagrams whose tag was right.
  void note(std::uint64_t counter) {
    if (counter > newest_) {
      const std::uint64_t ahead = counter - newest_;
      if (ahead >= kWidth) {
        seen_.fill(0);
      } else {
        for (std::uint64_t i = 1; i <= ahead; ++i) word(newest_ + i) &= ~bit(newest_ + i);
      }
      newest_ = counter;
    }
    word(counter) |= bit(counter);
  }

  std::uint64_t newest() const { return newest_; }

 private:
  static std::uint64_t bit(std::uint64_t counter) { return std::uint64_t{1} << (counter % 64); }
  static std::size_t place(std::uint64_t counter) {
    return static_cast<std::size_t>(counter / 64 % (kWidth / 64));
  }
  std::uint64_t& word(std::uint64_t counter) { return seen_[place(counter)]; }
  const std::uint64_t& word(std::uint64_t counter) const { return seen_[place(counter)]; }

  std::uint64_t newest_ = 0;
  std::array<std::uint64_t, kWidth / 64> seen_ = {};
};

}  // namespace zenith
