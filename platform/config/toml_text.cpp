#include "platform/config/toml_text.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "platform/base/printable.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == ' ' || c == '\t';
}

// Where the string that begins at `start` is over; the end of the text when it never is.
std::size_t end_of_string(std::string_view text, std::size_t start) {
  const char quote = text[start];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool many_lines = text.substr(start, 3) == three;
  for (std::size_t i = start + (many_lines ? 3 : 1); i < text.size(); ++i) {
    if (escapes && text[i] == '\\') {
      ++i;
    } else if (many_lines) {
      if (text.substr(i, 3) != three) continue;
      const std::size_t after = text.find_first_not_of(quote, i + 3);
      return std::min({i + 5, after, text.size()});  // two more may be the text's own last ones
    } else if (text[i] == quote || text[i] == '\n') {
      return i + 1;
    }
  }
  return text.size();
}

// Whether a backslash goes on, at once or on a further line, with a character outside of ASCII.
bool has_unfit_escape(std::string_view string) {
  if (string.front() != '"') return false;
  for (std::size_t i = string.find('\\'); i < string.size(); i = string.find('\\', i)) {
    const std::size_t next = string.find_first_not_of(" \t\r\n", i + 1);
    if (next >= string.size()) return false;
    if ((static_cast<unsigned char>(string[next]) & 0x80U) != 0) return true;
    i = next == i + 1 ? i + 2 : next;
  }
  return false;
}

// What toml++ must not see, and where.
struct Unfit {
  std::size_t at = 0;
  std::string what;
};

// toml++ takes for granted that a header goes on with a key.
bool begins_header(std::string_view text, std::size_t at) {
  const bool twice = text.substr(at, 2) == "[[";
  at += twice ? 2 : 1;
  at = std::min(text.find_first_not_of(" \t", at), text.size());
  if (at == text.size()) return true;
  const char c = text[at];
  return is_key_character(c) || c == '"' || c == '\'' || c == ']' || (c == '[' && !twice);
}

// Whether a word of four digits ends before `end`.
bool is_year(std::string_view text, std::size_t end) {
  constexpr std::string_view kDigits = "0123456789";
  const std::size_t before = text.substr(0, end).find_last_not_of(kDigits);
  const std::size_t first = before == std::string_view::npos ? 0 : before + 1;
  const bool begins_word = first == 0 || !is_key_character(text[first - 1]) ||
                           text[first - 1] == ' ' || text[first - 1] == '\t';
  return end - first == 4 && begins_word;
}

// Goes through a text once, with as much of its structure as it takes to tell keys from values.
class Inspection {
 public:
  explicit Inspection(std::string_view text) : text_(text) {}

  std::optional<Unfit> find() {
    for (; at_ < text_.size() && !unfit_; ++at_) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        string();
      } else if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
        dots_ = 0;
      } else {
        plain(c);
      }
      line_begins_ = text_[at_] == '\n' || (line_begins_ && (c == ' ' || c == '\t'));
    }
    return unfit_;
  }

 private:
  void tell(std::string what) { unfit_ = Unfit{at_, std::move(what)}; }

  void string() {
    const std::string_view before = in_value_ ? " \t\r\n=,[{" : " \t\r\n=,[{.";
    if (at_ > 0 && before.find(text_[at_ - 1]) == std::string_view::npos) {
      return tell("a quote in the midst of a word");
    }
    const std::size_t end = end_of_string(text_, at_);
    if (has_unfit_escape(text_.substr(at_, end - at_))) {
      return tell("a text with a character outside of ASCII behind a backslash");
    }
    at_ = end - 1;
    if (text_[at_] == '\n') dots_ = 0;
  }

  void plain(char c) {
    const bool in_array = !open_.empty() && open_.back() == '[';
    if (c == '.' && ++dots_ > kMaxKeyDots) {
      tell("a key with more than " + std::to_string(kMaxKeyDots) + " dots");
    } else if (c == '-' && is_year(text_, at_)) {
      tell("a date: none is expected; a text stands in quotes");
    } else if (c == ':') {
      tell("a colon that stands in no quotes: expected key = value, and no time of day");
    } else if ((static_cast<unsigned char>(c) & 0x80U) != 0) {
      tell("a character outside of ASCII that stands in no quotes");
    }
    if (c != '.' && !is_key_character(c)) dots_ = 0;
    if (c == '=') in_value_ = true;
    if (c == ',') in_value_ = in_array;
    if (c == '\n' && open_.empty()) in_value_ = false;
    if (c == '[' || c == '{') open(c);
    if (c == ']' || c == '}') close(c);
  }

  void open(char c) {
    const bool header = c == '[' && line_begins_ && open_.empty();
    if (header && !begins_header(text_, at_)) return tell("expected a section's name behind [");
    in_value_ = c == '[' && !header && in_value_;
    open_ += c;
  }

  void close(char c) {
    if (open_.empty()) return;
    if (open_.back() != (c == ']' ? '[' : '{')) {
      return tell(std::string("expected the end of ") + open_.back() + ", found " + c);
    }
    open_.pop_back();
    in_value_ = true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t dots_ = 0;   // of the key at hand
  std::string open_;       // brackets and braces
  bool in_value_ = false;  // not in a key
  bool line_begins_ = true;
  std::optional<Unfit> unfit_;
};

// Within comments and strings, too.
std::optional<Unfit> find_control_character(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = first_character(text.substr(at));
    const std::uint32_t code = character.code;
    if (!character.valid) return Unfit{at, "a byte that is no UTF-8"};
    const bool blank = code == '\t' || code == '\n' || code == '\r';
    if ((code < 0x20 && !blank) || code == 0x7f) return Unfit{at, "a control character"};
    at += character.size;
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> read_toml(const std::filesystem::path& path) {
  return read_text_input(path.string(), kMaxTomlBytes);
}

toml::parse_result parse_toml(std::string_view text) {
  auto unfit = find_control_character(text);
  if (!unfit) unfit = Inspection(text).find();
  if (!unfit) return toml::parse(text);
  const std::string_view before = text.substr(0, unfit->at);
  const auto lines = std::count(before.begin(), before.end(), '\n');
  const toml::source_position place = {static_cast<toml::source_index>(lines + 1), 1};
  return toml::parse_result(toml::parse_error(std::move(unfit->what), place));
}

Error toml_error(const std::filesystem::path& path, const toml::parse_error& error) {
  return {path.string() + ":" + std::to_string(error.source().begin.line) + ": " +
          std::string(error.description())};
}

}  // namespace zenith
