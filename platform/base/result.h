#pragma once
// Errors are values: what was expected, what was found, what to do. No exceptions.

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "platform/base/ensure.h"

namespace zenith {

// One message for a person. Says what was expected, what was found and what to do.
struct Error {
  std::string message;
};

// Either a T or an Error. Reading the wrong one is a programmer's mistake and ends the
// program, in every build.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return ok(); }

  T& value() {
    ensure(ok(), "Result: read the value of an error");
    return *std::get_if<T>(&state_);
  }
  const T& value() const {
    ensure(ok(), "Result: read the value of an error");
    return *std::get_if<T>(&state_);
  }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const {
    ensure(!ok(), "Result: read the error of a success");
    return *std::get_if<Error>(&state_);
  }

 private:
  std::variant<T, Error> state_;
};

// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const {
    ensure(!ok(), "Result: read the error of a success");
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;

}  // namespace zenith
