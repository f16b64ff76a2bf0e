#pragma once
// Frames on their way to the disk: compressed by a few threads, listed in their order.
//
// One thread adds and collects. Memory is taken when it is made.

#include <array>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "platform/base/result.h"
#include "platform/recording/writer.h"

namespace zenith::tools {

class FrameStore {
 public:
  static constexpr std::size_t kPlaces = 32;

  // `writer` must outlive it. `compression`: as write_grey_png().
  FrameStore(RecordingWriter& writer, int compression, int threads);
  ~FrameStore();
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;

  // Copies the frame. False when no place has become free within `patience`: the frame is left out.
  bool add(Time stamp, ImageView frame, Duration patience);
  // Lists those that are complete by now. The first error stays.
  Status collect();
  // Waits until all are complete, and lists them.
  Status finish();

  std::uint64_t frames() const { return listed_; }
  std::uint64_t bytes() const { return bytes_; }  // of listed frames

 private:
  enum class State { kFree, kWaiting, kTaken, kDone };
  struct Place {
    State state = State::kFree;
    Time stamp;
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> pixels;
    std::uint64_t bytes = 0;
    std::optional<Error> error;
  };

  void work();
  Place* take();
  Status collect_locked();

  RecordingWriter& writer_;
  const int compression_;
  std::mutex mutex_;
  std::condition_variable waiting_;  // a frame waits, or the end
  std::condition_variable done_;     // a frame is complete
  std::array<Place, kPlaces> places_;
  std::uint64_t added_ = 0;  // ordinal numbers; place i holds those that are i modulo kPlaces
  std::uint64_t taken_ = 0;
  std::uint64_t listed_places_ = 0;
  std::uint64_t listed_ = 0;
  std::uint64_t bytes_ = 0;
  Status status_;
  bool stop_ = false;
  std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace zenith::tools
