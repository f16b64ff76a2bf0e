#include "platform/daemon/cooperation.h"

#include "platform/linux/clock.h"

namespace zenith {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

}  // namespace

void Cooperation::run(const std::atomic<bool>& stop) {
  constexpr Duration kPeriod = {10'000'000};
  while (!stop.load(kRelaxed)) {
    turn_once();
    sleep_until(monotonic_now() + kPeriod);
  }
}

void Cooperation::turn_once() {
  send_own();
  if (link_ != nullptr) receive();
}

void Cooperation::send_own() {
  std::size_t count = 0;
  do {
    for (count = 0; count < batch_.size() && exchange_.own.pop(batch_[count]);) ++count;
    if (link_ != nullptr && count > 0) link_->send(std::span(batch_).first(count));
    (link_ != nullptr ? sent_ : unheard_).fetch_add(count, kRelaxed);
  } while (count == batch_.size());
  MergeNews merge;
  while (exchange_.own_merges.pop(merge)) {
    if (link_ != nullptr) link_->send_merge(merge);
  }
}

void Cooperation::receive() {
  while (holds_ || link_->receive(held_)) {
    holds_ = !exchange_.peers.push(held_);
    if (holds_) break;  // perception is behind: later
    received_.fetch_add(1, kRelaxed);
  }
  MergeNews merge;
  while (link_->receive_merge(merge)) exchange_.merges_with_us.push(merge);
}

CooperationCounters Cooperation::counters() const {
  return {sent_.load(kRelaxed), unheard_.load(kRelaxed), received_.load(kRelaxed)};
}

}  // namespace zenith
