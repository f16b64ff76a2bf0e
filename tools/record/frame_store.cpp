#include "tools/record/frame_store.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace zenith::tools {

FrameStore::FrameStore(RecordingWriter& writer, int compression, int threads)
    : writer_(writer), compression_(compression) {
  for (int i = 0; i < std::max(threads, 1); ++i) threads_.emplace_back([this] { work(); });
}

FrameStore::~FrameStore() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  waiting_.notify_all();
}

bool FrameStore::add(Time stamp, ImageView frame, Duration patience) {
  std::unique_lock lock(mutex_);
  Place& place = places_[added_ % kPlaces];
  const bool free = done_.wait_for(lock, std::chrono::nanoseconds(patience.ns), [&] {
    (void)collect_locked();
    return place.state == State::kFree;
  });
  if (!free || !status_) return false;
  const auto row = static_cast<std::size_t>(frame.width);
  place.stamp = stamp;
  place.width = frame.width;
  place.height = frame.height;
  place.pixels.resize(row * static_cast<std::size_t>(frame.height));
  for (int v = 0; v < frame.height; ++v) {
    std::memcpy(place.pixels.data() + static_cast<std::size_t>(v) * row, frame.row(v), row);
  }
  place.state = State::kWaiting;
  ++added_;
  waiting_.notify_one();
  return true;
}

Status FrameStore::collect() {
  const std::scoped_lock lock(mutex_);
  return collect_locked();
}

Status FrameStore::finish() {
  std::unique_lock lock(mutex_);
  done_.wait(lock, [&] {
    (void)collect_locked();
    return listed_places_ == added_;
  });
  return status_;
}

// In the order in which they were added. After an error nothing more is listed.
Status FrameStore::collect_locked() {
  while (listed_places_ < added_) {
    Place& place = places_[listed_places_ % kPlaces];
    if (place.state != State::kDone) break;
    if (place.error && status_) status_ = *place.error;
    if (!place.error && status_) {
      writer_.list_frame(place.stamp);
      ++listed_;
      bytes_ += place.bytes;
    }
    place.state = State::kFree;
    ++listed_places_;
  }
  return status_;
}

FrameStore::Place* FrameStore::take() {
  std::unique_lock lock(mutex_);
  waiting_.wait(lock, [this] { return taken_ < added_ || stop_; });
  if (taken_ == added_) return nullptr;
  Place& place = places_[taken_++ % kPlaces];
  place.state = State::kTaken;
  return &place;
}

void FrameStore::work() {
  while (Place* place = take()) {
    const ImageView image = {place->pixels.data(), place->width, place->height, place->width};
    const auto written = writer_.write_frame(place->stamp, image, compression_);
    {
      const std::scoped_lock lock(mutex_);
      place->bytes = written ? *written : 0;
      place->error = written ? std::optional<Error>() : std::optional<Error>(written.error());
      place->state = State::kDone;
    }
    done_.notify_all();
  }
}

}  // namespace zenith::tools
