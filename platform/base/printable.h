#pragma once
// Text from outside (files, sockets, file names) made fit for a terminal or a line of a log.
//
// Shown as an escape, never raw: control characters (C0 and DEL as \x1b, C1 as \u009b), characters
// that end a line or turn its direction (U+2028, U+2029, U+202A to U+202E, U+2066 to U+2069: as
// \u202e), and each byte that is not UTF-8 (\xff). All other characters stay as they are.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace zenith {

// The first character of a text that is not empty.
struct Utf8Character {
  std::uint32_t code = 0;
  std::size_t size = 1;  // in bytes
  bool valid = false;    // false: `code` is the first byte, which begins no character
};

// Strict, as RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.
inline Utf8Character first_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const Utf8Character invalid = {byte(0), 1, false};
  if (byte(0) < 0x80) return {byte(0), 1, true};
  const std::size_t size = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < size) return invalid;
  std::uint32_t code = byte(0) & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return invalid;
    code = code << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::uint32_t kLeast[] = {0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kLeast[size - 2] || code > 0x10ffff || surrogate) return invalid;
  return {code, size, true};
}

// Whether a terminal may get the character as it is.
inline bool is_printable(const Utf8Character& character) {
  const auto within = [code = character.code](std::uint32_t first, std::uint32_t last) {
    return code >= first && code <= last;
  };
  return character.valid && !within(0, 0x1f) && !within(0x7f, 0x9f) && !within(0x2028, 0x202e) &&
         !within(0x2066, 0x2069);
}

// Whether all of the text may go to a terminal as it is.
inline bool is_printable(std::string_view text) {
  while (!text.empty()) {
    const Utf8Character character = first_character(text);
    if (!is_printable(character)) return false;
    text.remove_prefix(character.size);
  }
  return true;
}

inline constexpr std::size_t kMaxRobotName = 32;  // bytes

// The rule for every robot's name: configuration, datagrams, stored maps, recordings.
inline bool is_robot_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxRobotName && is_printable(name);
}

enum class LineEnds : std::uint8_t {
  kEscape,  // the text is one line
  kKeep,    // line feeds and tabs stay: a text of several lines, most of it our own
};

struct PrintableSize {
  std::size_t read = 0;     // bytes of the text that are shown; the rest found no room
  std::size_t written = 0;  // bytes of the output
};

// Into a buffer, whole characters and escapes only; no heap and no final NUL.
inline PrintableSize write_printable(std::string_view text, std::span<char> out,
                                     LineEnds line_ends = LineEnds::kEscape) {
  constexpr char kDigits[] = "0123456789abcdef";
  constexpr std::size_t kLongestEscape = 6;
  PrintableSize size;
  while (size.read < text.size()) {
    const std::string_view rest = text.substr(size.read);
    const Utf8Character character = first_character(rest);
    const bool kept = line_ends == LineEnds::kKeep && (rest[0] == '\n' || rest[0] == '\t');
    char escape[kLongestEscape];
    std::string_view shown = rest.substr(0, character.size);
    if (!kept && !is_printable(character)) {
      const bool is_byte = !character.valid || character.code < 0x80;
      const std::size_t digits = is_byte ? 2 : 4;
      escape[0] = '\\';
      escape[1] = is_byte ? 'x' : 'u';
      for (std::size_t i = 0; i < digits; ++i) {
        escape[2 + i] = kDigits[character.code >> (4 * (digits - 1 - i)) & 0xfU];
      }
      shown = {escape, 2 + digits};
    }
    if (shown.size() > out.size() - size.written) break;
    shown.copy(out.data() + size.written, shown.size());
    size.written += shown.size();
    size.read += character.size;
  }
  return size;
}

// As above. What does not fit is cut and the output ends in "..."; `already_cut` says that the text
// itself is the beginning of a longer one, perhaps ended within a character. Returns the bytes
// written. `out` holds at least three more bytes than the text's last character.
inline std::size_t write_printable_cut(std::string_view text, std::span<char> out,
                                       bool already_cut) {
  constexpr std::string_view kCut = "...";
  const PrintableSize whole = write_printable(text, out);
  if (!already_cut && whole.read == text.size()) return whole.written;
  const std::size_t room = out.size() - std::min(out.size(), kCut.size());
  const std::size_t kept = write_printable(text, out.first(room)).written;
  return kept + kCut.copy(out.data() + kept, out.size() - kept);
}

inline std::string printable(std::string_view text, LineEnds line_ends = LineEnds::kEscape) {
  std::string shown;
  char part[256];
  while (!text.empty()) {
    const PrintableSize size = write_printable(text, part, line_ends);
    shown.append(part, size.written);
    text.remove_prefix(size.read);
  }
  return shown;
}

// At most `limit` bytes; a longer one ends in "...".
inline std::string printable_start(std::string_view text, std::size_t limit) {
  std::string shown(limit, '\0');
  // A character or escape takes at least as many bytes shown as read.
  const bool cut = text.size() > limit;
  shown.resize(write_printable_cut(text.substr(0, limit), shown, cut));
  return shown;
}

}  // namespace zenith
