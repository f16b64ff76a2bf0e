#pragma once
// A vector with a fixed capacity and plain elements, stored in place. Full: push_back() rejects.
// An index beyond the end ends the program, in every build (ensure.h).

#include <array>
#include <cstddef>
#include <span>

#include "platform/base/ensure.h"

namespace zenith {

template <typename T, std::size_t Capacity>
class FixedVector {
 public:
  // False when full; the element is then not taken.
  bool push_back(const T& value) {
    if (size_ == Capacity) return false;
    items_[size_++] = value;
    return true;
  }
  void clear() { size_ = 0; }
  // Order is not kept: the last element takes the place of the removed one.
  void swap_remove(std::size_t i) {
    ensure(i < size_, "FixedVector: no such element to remove");
    items_[i] = items_[--size_];
  }
  void shrink_to(std::size_t size) {
    ensure(size <= size_, "FixedVector: cannot shrink to more");
    size_ = size;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == Capacity; }
  static constexpr std::size_t capacity() { return Capacity; }

  T& operator[](std::size_t i) {
    ensure(i < size_, "FixedVector: index beyond the end");
    return items_[i];
  }
  const T& operator[](std::size_t i) const {
    ensure(i < size_, "FixedVector: index beyond the end");
    return items_[i];
  }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }
  std::span<T> span() { return {items_.data(), size_}; }
  std::span<const T> span() const { return {items_.data(), size_}; }

 private:
  std::array<T, Capacity> items_ = {};
  std::size_t size_ = 0;
};

}  // namespace zenith
