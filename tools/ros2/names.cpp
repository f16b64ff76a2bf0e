#include "tools/ros2/names.h"

#include <cstdint>

#include "tools/view/placement.h"

namespace zenith::ros2 {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_plain(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// FNV-1a, folded to 32 bits. Whoever finds two names with one hash is refused (RobotTopics).
std::string hash_digits(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  const auto folded = static_cast<std::uint32_t>(hash ^ hash >> 32U);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out;
  for (unsigned shift = 32; shift > 0; shift -= 4) out += kDigits[folded >> (shift - 4) & 0xfU];
  return out;
}

// What only this mapping makes.
bool is_reserved(std::string_view name) {
  constexpr std::string_view kPast = "past_self";
  if (name.size() >= kPast.size() && name.substr(name.size() - kPast.size()) == kPast) return true;
  constexpr std::size_t kHashed = 9;
  if (name.size() < kHashed || name[name.size() - kHashed] != '_') return false;
  return name.substr(name.size() - kHashed + 1).find_first_not_of("0123456789abcdef") ==
         std::string_view::npos;
}

}  // namespace

std::string ros_name(std::string_view name) {
  if (name == tools::kPastSelf) return "past_self";
  const std::string past = " " + std::string(tools::kPastSelf);
  if (name.size() > past.size() && name.substr(name.size() - past.size()) == past) {
    return ros_name(name.substr(0, name.size() - past.size())) + "_past_self";
  }
  std::string out;
  for (const char c : name) {
    const char put = is_plain(c) ? c : '_';
    if (put == '_' && !out.empty() && out.back() == '_') continue;
    out += put;
  }
  if (out.empty() || is_digit(out[0])) out.insert(0, "r");
  if (out == name && !is_reserved(name)) return out;
  if (out.back() == '_') out.pop_back();
  return out + (out.empty() ? "r_" : "_") + hash_digits(name);
}

RobotNames::RobotNames(std::string_view robot, const FrameNames& frames, bool prefixed)
    : robot_(ros_name(robot)), prefix_(prefixed ? robot_ + "/" : ""), frames_(frames) {}

std::string RobotNames::topic(std::string_view name) const {
  return "rt/" + prefix_ + std::string(name);
}

std::string RobotNames::map_of(std::string_view other) const {
  return ros_name(other) + "/" + frames_.map;
}

}  // namespace zenith::ros2
