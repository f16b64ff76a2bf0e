#pragma once
// A participant of a DDS domain and its writers, with the qualities of service that ROS 2 expects.
// Cyclone DDS has threads of its own; these objects are for one thread.

#include <cstdint>
#include <string>
#include <utility>

#include "platform/base/result.h"
#include "tools/ros2/topic_types.h"

namespace zenith::ros2 {

// Something of DDS that ends with its owner.
class Entity {
 public:
  Entity() = default;
  explicit Entity(std::int32_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity();

  std::int32_t get() const { return handle_; }

 private:
  std::int32_t handle_ = 0;
};

class Participant {
 public:
  // `localhost`: on this computer alone, as ROS_LOCALHOST_ONLY=1 asks. CYCLONEDDS_URI has the rest.
  static Result<Participant> join(std::uint32_t domain, bool localhost);

  std::int32_t get() const { return entity_.get(); }

 private:
  Entity domain_;
  Entity entity_;
};

// Reliable. `latched`: who comes later gets the last `depth` samples (ROS 2: transient local).
struct Quality {
  int depth = 10;
  bool latched = false;
};

class Writer {
 public:
  // `topic` as DDS has it: "rt/odom".
  static Result<Writer> make(const Participant& participant, const std::string& topic,
                             const TopicType& type, const Quality& quality);

  // `message` is the type's struct; it is copied. Waits at most 100 ms for readers that are behind.
  Status write(const void* message) const;

 private:
  std::string topic_;
  Entity description_;
  Entity writer_;
};

}  // namespace zenith::ros2
