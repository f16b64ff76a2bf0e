#include "drivers/odometry/dbc.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "drivers/odometry/dbc_scanner.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxSignals = 50'000;
constexpr std::size_t kMaxName = 128;  // four times that of the format's description
constexpr std::size_t kMaxProblems = 10;
constexpr std::uint32_t kExtendedFlag = 0x80000000U;

struct Message {
  std::string name;
  std::uint32_t written_id = 0;
  std::uint32_t bytes = 0;
};

constexpr const char* kMessageForm = "a message, BO_ ID NAME: BYTES SENDER";
constexpr const char* kSignalForm =
    "a signal, SG_ NAME : START|LENGTH@ORDER SIGN (SCALE,OFFSET) [MIN|MAX] \"UNIT\" RECEIVER";
constexpr const char* kTypeForm = "a type, SIG_VALTYPE_ ID SIGNAL : TYPE with TYPE 0, 1 or 2";

bool is_name(std::string_view word) {
  return !word.empty() && word.size() <= kMaxName;
}

std::optional<Message> parse_message(DbcScanner& line) {
  Message message;
  const auto id = line.take_number<std::uint32_t>();
  message.name = line.take_word();
  const bool colon = line.take(':');
  const auto bytes = line.take_number<std::uint32_t>();
  if (!id || !is_name(message.name) || !colon || !bytes) return std::nullopt;
  message.written_id = *id;
  message.bytes = *bytes;
  return message;
}

bool is_multiplexing(std::string_view word) {
  if (word == "M") return true;
  if (word.size() < 2 || word.front() != 'm') return false;
  word.remove_prefix(1);
  if (word.size() > 1 && word.back() == 'M') word.remove_suffix(1);
  return word.find_first_not_of("0123456789") == std::string_view::npos;
}

// START|LENGTH@ORDER SIGN
bool parse_bits(DbcScanner& line, DbcSignal& signal) {
  const auto start = line.take_number<std::uint32_t>();
  if (!start || !line.take('|')) return false;
  const auto length = line.take_number<std::uint32_t>();
  if (!length || !line.take('@')) return false;
  signal.start_bit = *start;
  signal.bit_length = *length;
  signal.motorola = line.take('0');
  if (!signal.motorola && !line.take('1')) return false;
  if (line.take('-')) {
    signal.value = DbcValue::kSigned;
    return true;
  }
  return line.take('+');
}

// A pair of numbers such as (1,0) or [0|0].
std::optional<std::pair<double, double>> parse_pair(DbcScanner& line, const char* marks) {
  if (!line.take(marks[0])) return std::nullopt;
  const auto first = line.take_number<double>();
  if (!first || !line.take(marks[1])) return std::nullopt;
  const auto second = line.take_number<double>();
  if (!second || !line.take(marks[2])) return std::nullopt;
  return std::pair(*first, *second);
}

std::optional<DbcEntry> parse_signal(DbcScanner& line) {
  DbcEntry entry;
  entry.name = line.take_word();
  entry.multiplexing = line.take_word();
  if (!entry.multiplexing.empty() && !is_multiplexing(entry.multiplexing)) return std::nullopt;
  if (!is_name(entry.name) || !line.take(':') || !parse_bits(line, entry.signal))
    return std::nullopt;
  const auto factor = parse_pair(line, "(,)");
  if (!factor || !parse_pair(line, "[|]")) return std::nullopt;
  const auto unit = line.take_quoted();
  if (!unit) return std::nullopt;
  entry.signal.scale = factor->first;
  entry.signal.offset = factor->second;
  entry.unit = *unit;
  return entry;
}

class Parser {
 public:
  explicit Parser(const std::string& path) : file_{path, {}} {}

  void line(std::string_view text) {
    ++line_;
    const bool inside_text = in_quotes_;
    for (const char c : text) in_quotes_ ^= c == '"';
    if (inside_text) return;
    DbcScanner scanner(text);
    const std::string_view keyword = scanner.take_word();
    if (keyword == "BO_") {
      message(scanner);
    } else if (keyword == "SG_") {
      signal(scanner);
    } else if (keyword == "SIG_VALTYPE_" && !scanner.empty()) {  // alone: in the list NS_
      type(scanner);
    }
  }

  Result<DbcFile> finish() {
    if (problem_count_ > kMaxProblems) {
      problems_ += "\n" + file_.path + ": " + std::to_string(problem_count_ - kMaxProblems) +
                   " more malformed lines";
    }
    if (problem_count_ > 0) return Error{problems_};
    if (!file_.signals.empty()) return std::move(file_);
    return Error{file_.path + ": holds no signal, expected a DBC file with BO_ and SG_ lines"};
  }

 private:
  void problem(const std::string& what) {
    if (++problem_count_ > kMaxProblems) return;
    problems_ +=
        (problems_.empty() ? "" : "\n") + file_.path + ":" + std::to_string(line_) + ": " + what;
  }

  void message(DbcScanner& scanner) {
    const auto parsed = parse_message(scanner);
    has_message_ = parsed.has_value();
    if (parsed) message_ = *parsed;
    if (!parsed) problem(std::string("expected ") + kMessageForm);
  }

  void signal(DbcScanner& scanner) {
    auto entry = parse_signal(scanner);
    if (!entry) return problem(std::string("expected ") + kSignalForm);
    if (!has_message_) return problem("the signal " + entry->name + " stands in no message (BO_)");
    entry->message = message_.name;
    entry->written_id = message_.written_id;
    entry->frame_bytes = message_.bytes;
    entry->line = line_;
    entry->signal.id = {message_.written_id & ~kExtendedFlag,
                        (message_.written_id & kExtendedFlag) != 0};
    if (file_.signals.size() == kMaxSignals) {
      return problem("expected at most " + std::to_string(kMaxSignals) + " signals");
    }
    by_name_.emplace(std::pair(entry->written_id, entry->name), file_.signals.size());
    file_.signals.push_back(std::move(*entry));
  }

  void type(DbcScanner& scanner) {
    const auto id = scanner.take_number<std::uint32_t>();
    const std::string_view name = scanner.take_word();
    scanner.take(':');  // some writers leave it out
    const auto type = scanner.take_number<std::uint32_t>();
    if (!id || !is_name(name) || !type || *type > 2) {
      return problem(std::string("expected ") + kTypeForm);
    }
    const auto found = by_name_.find(std::pair(*id, std::string(name)));
    if (found == by_name_.end()) {
      return problem("gives a type to the signal " + std::string(name) + " of message " +
                     std::to_string(*id) + ", which is not in the lines before");
    }
    DbcSignal& signal = file_.signals[found->second].signal;
    if (*type == 1) signal.value = DbcValue::kFloat32;
    if (*type == 2) signal.value = DbcValue::kFloat64;
  }

  DbcFile file_;
  // The place in `file_` of a message's signal: the first one of that name.
  std::map<std::pair<std::uint32_t, std::string>, std::size_t> by_name_;
  Message message_;
  bool has_message_ = false;
  bool in_quotes_ = false;  // comments may run over several lines
  int line_ = 0;
  std::size_t problem_count_ = 0;
  std::string problems_;
};

// Why the signal cannot be read from classic frames; empty when it can.
std::string unusable(const DbcEntry& entry) {
  const DbcSignal& signal = entry.signal;
  const std::uint32_t length = signal.bit_length;
  if (!entry.multiplexing.empty() && entry.multiplexing != "M") {
    return "is multiplexed (" + entry.multiplexing +
           "): such signals are not supported; choose one that is in every frame";
  }
  if (signal.id.id > (signal.id.extended ? 0x1FFFFFFFU : 0x7FFU)) {
    return "belongs to the message " + std::to_string(entry.written_id) +
           ", which is no CAN identifier: 11 bits, or 29 bits plus 2147483648";
  }
  if (length < 1 || length > 64) {
    return "has " + std::to_string(length) + " bits, expected 1 .. 64";
  }
  const std::uint32_t room = std::min<std::uint32_t>(entry.frame_bytes, 8);
  if (signal.start_bit >= 64 || bytes_needed(signal) > room) {
    return "does not fit into the " + std::to_string(room) + " bytes of a classic frame of " +
           entry.message;
  }
  if ((signal.value == DbcValue::kFloat32 && length != 32) ||
      (signal.value == DbcValue::kFloat64 && length != 64)) {
    return "is a float of " + std::to_string(length) + " bits: SIG_VALTYPE_ 1 needs 32, 2 needs 64";
  }
  if (!std::isfinite(signal.scale) || signal.scale == 0.0 || !std::isfinite(signal.offset)) {
    return "has a scale or offset that is zero or no number";
  }
  return "";
}

}  // namespace

Result<DbcFile> parse_dbc(std::string_view text, const std::string& path) {
  Parser parser(path);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    parser.line(line);
  }
  return parser.finish();
}

Result<DbcFile> load_dbc(const std::string& path) {
  const auto text = read_text_input(path, kMaxDbcBytes);
  if (text) return parse_dbc(*text, path);
  return Error{text.error().message + "; expected the base's DBC file there"};
}

Result<DbcEntry> find_signal(const DbcFile& file, std::string_view name) {
  const std::size_t dot = name.find('.');
  const bool qualified = dot != std::string_view::npos;
  const std::string_view message = qualified ? name.substr(0, dot) : std::string_view();
  const std::string_view signal = qualified ? name.substr(dot + 1) : name;
  const DbcEntry* found = nullptr;
  for (const DbcEntry& entry : file.signals) {
    if (entry.name != signal || (qualified && entry.message != message)) continue;
    if (found != nullptr) {
      return Error{file.path + ": the signal " + std::string(name) + " is in the messages " +
                   found->message + " (line " + std::to_string(found->line) + ") and " +
                   entry.message + " (line " + std::to_string(entry.line) +
                   "): name it as MESSAGE.SIGNAL"};
    }
    found = &entry;
  }
  if (found == nullptr) {
    return Error{file.path + ": has no signal '" + std::string(name) +
                 "': expected SIGNAL or MESSAGE.SIGNAL, as in its " +
                 std::to_string(file.signals.size()) + " SG_ lines"};
  }
  const std::string reason = unusable(*found);
  if (reason.empty()) return *found;
  return Error{file.path + ":" + std::to_string(found->line) + ": the signal " + found->message +
               "." + found->name + " " + reason};
}

}  // namespace zenith
