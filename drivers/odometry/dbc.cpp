#include "drivers/odometry/dbc.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "drivers/odometry/dbc_scanner.h"
#include "platform/base/printable.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

constexpr std::size_t kMaxSignals = 50'000;
constexpr std::size_t kMaxName = 128;  // four times that of the format's description
constexpr std::size_t kMaxProblems = 10;
constexpr std::size_t kMaxMultiplexDigits = 18;  // of a number below 2^63
constexpr std::uint32_t kExtendedFlag = 0x80000000U;

struct Message {
  std::string name;
  std::uint32_t written_id = 0;
  std::uint32_t bytes = 0;
};

constexpr const char* kMessageForm = "a message, BO_ ID NAME: BYTES SENDER";
constexpr const char* kSignalForm =
    "a signal, SG_ NAME : START|LENGTH@ORDER SIGN (SCALE,OFFSET) [MIN|MAX] \"UNIT\" RECEIVER";
constexpr const char* kTypeForm = "a type, SIG_VALTYPE_ ID SIGNAL : TYPE; with TYPE 0, 1 or 2";
constexpr const char* kRangesForm =
    "a multiplexed signal, SG_MUL_VAL_ ID SIGNAL SELECTOR FIRST-LAST, ...;";

bool is_name(std::string_view word) {
  return !word.empty() && word.size() <= kMaxName;
}

std::optional<Message> parse_message(DbcScanner& in) {
  Message message;
  const auto id = in.take_number<std::uint32_t>();
  message.name = in.take_word();
  const bool colon = in.take(':');
  const auto bytes = in.take_number<std::uint32_t>();
  if (!id || !is_name(message.name) || !colon || !bytes) return std::nullopt;
  message.written_id = *id;
  message.bytes = *bytes;
  if (!is_dbc_keyword(in.peek_word())) in.take_name();  // the sender
  return message;
}

bool is_multiplexing(std::string_view word) {
  if (word == "M") return true;
  if (word.size() < 2 || word.front() != 'm') return false;
  word.remove_prefix(1);
  if (word.size() > 1 && word.back() == 'M') word.remove_suffix(1);
  return word.size() <= kMaxMultiplexDigits &&
         word.find_first_not_of("0123456789") == std::string_view::npos;
}

// START|LENGTH@ORDER SIGN
bool parse_bits(DbcScanner& in, DbcSignal& signal) {
  const auto start = in.take_number<std::uint32_t>();
  if (!start || !in.take('|')) return false;
  const auto length = in.take_number<std::uint32_t>();
  if (!length || !in.take('@')) return false;
  signal.start_bit = *start;
  signal.bit_length = *length;
  signal.motorola = in.take('0');
  if (!signal.motorola && !in.take('1')) return false;
  if (in.take('-')) {
    signal.value = DbcValue::kSigned;
    return true;
  }
  return in.take('+');
}

// A pair of numbers such as (1,0) or [0|0].
std::optional<std::pair<double, double>> parse_pair(DbcScanner& in, const char* marks) {
  if (!in.take(marks[0])) return std::nullopt;
  const auto first = in.take_number<double>();
  if (!first || !in.take(marks[1])) return std::nullopt;
  const auto second = in.take_number<double>();
  if (!second || !in.take(marks[2])) return std::nullopt;
  return std::pair(*first, *second);
}

// Names up to the next statement.
void skip_names(DbcScanner& in) {
  while (!is_dbc_keyword(in.peek_word())) {
    if (in.take_name().empty() && !in.take(',')) return;
  }
}

std::optional<DbcEntry> parse_signal(DbcScanner& in) {
  DbcEntry entry;
  entry.name = in.take_word();
  entry.multiplexing = in.take_word();
  if (!entry.multiplexing.empty() && !is_multiplexing(entry.multiplexing)) return std::nullopt;
  if (!is_name(entry.name) || !in.take(':') || !parse_bits(in, entry.signal)) return std::nullopt;
  const auto factor = parse_pair(in, "(,)");
  if (!factor || !parse_pair(in, "[|]")) return std::nullopt;
  const auto unit = in.take_text(TextEnd::kAny);
  if (!unit) return std::nullopt;
  entry.signal.scale = factor->first;
  entry.signal.offset = factor->second;
  entry.unit = *unit;
  skip_names(in);  // the receivers
  return entry;
}

// Where the texts of a statement end that is passed over: its first one, and the others.
struct TextEnds {
  TextEnd first = TextEnd::kAny;
  TextEnd other = TextEnd::kAny;
};

TextEnds text_ends(std::string_view keyword) {
  if (keyword == "CM_") return {TextEnd::kStatement, TextEnd::kStatement};
  if (keyword == "VAL_" || keyword == "VAL_TABLE_") return {TextEnd::kTable, TextEnd::kTable};
  if (keyword == "BA_DEF_" || keyword == "BA_DEF_REL_" || keyword == "BA_DEF_SGTYPE_") {
    return {TextEnd::kAny, TextEnd::kList};
  }
  if (keyword.starts_with("BA_")) return {TextEnd::kAny, TextEnd::kStatement};
  return {};
}

bool is_object(std::string_view word) {
  return word == "BU_" || word == "BO_" || word == "SG_" || word == "EV_";
}

// The list behind "NS_ :": lines of nothing but the format's own symbols.
bool is_symbol_line(std::string_view line) {
  for (DbcScanner words(line); !words.empty();) {
    const std::string_view word = words.take_word();
    if (word.empty() || (word.back() != '_' && word != "FILTER")) return false;
  }
  return true;
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : in_(text), file_{path, {}} {}

  Result<DbcFile> parse() {
    while (!in_.empty()) {
      line_ = in_.line();
      problems_before_ = problem_count_;
      statement();
      if (problem_count_ != problems_before_) pass_to_next_statement();
    }
    for (const Extension& extension : extensions_) extend(extension);
    if (problem_count_ > kMaxProblems) {
      problems_ += "\n" + file_.path + ": " + std::to_string(problem_count_ - kMaxProblems) +
                   " more malformed statements";
    }
    if (problem_count_ > 0) return Error{problems_};
    if (!file_.signals.empty()) return std::move(file_);
    return Error{file_.path + ": holds no signal, expected a DBC file with BO_ and SG_ lines"};
  }

 private:
  // What SIG_VALTYPE_ and SG_MUL_VAL_ say of a signal.
  struct Extension {
    int line = 0;
    std::uint32_t written_id = 0;
    std::string name;
    std::uint32_t type = 0;
    std::string selector;
    std::vector<DbcRange> ranges;
  };

  void problem(const std::string& what) {
    if (++problem_count_ > kMaxProblems) return;
    problems_ +=
        (problems_.empty() ? "" : "\n") + file_.path + ":" + std::to_string(line_) + ": " + what;
  }

  // The parser's place is somewhere in a malformed statement.
  void pass_to_next_statement() {
    if (in_.begins_line() && is_dbc_keyword(in_.peek_word()) && in_.line() > line_) return;
    do {
      in_.take_line();
    } while (!in_.empty() && !(in_.begins_line() && is_dbc_keyword(in_.peek_word())));
  }

  void statement() {
    const std::string_view keyword = in_.peek_word();
    if (!is_dbc_keyword(keyword)) {
      return problem("expected a statement of the DBC format (BO_, SG_, CM_, ...), found '" +
                     printable_start(in_.rest_of_line(), 40) + "'");
    }
    in_.take_word();
    if (keyword == "BO_") return message();
    if (keyword == "SG_") return signal();
    if (keyword == "SIG_VALTYPE_") return type();
    if (keyword == "SG_MUL_VAL_") return multiplexing();
    if (keyword == "NS_") return symbols();
    if (keyword == "BS_") return bit_timing();
    if (keyword == "BU_") return nodes();
    if (keyword == "VERSION") return version();
    pass_over(keyword);
  }

  void message() {
    const auto parsed = parse_message(in_);
    has_message_ = parsed.has_value();
    if (parsed) message_ = *parsed;
    if (!parsed) problem(std::string("expected ") + kMessageForm);
  }

  void signal() {
    auto entry = parse_signal(in_);
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

  void type() {
    Extension extension;
    extension.line = line_;
    const auto id = in_.take_number<std::uint32_t>();
    extension.name = in_.take_word();
    in_.take(':');  // some writers leave it out
    const auto type = in_.take_number<std::uint32_t>();
    if (!id || !is_name(extension.name) || !type || *type > 2 || !in_.take(';')) {
      return problem(std::string("expected ") + kTypeForm);
    }
    extension.written_id = *id;
    extension.type = *type;
    add(std::move(extension));
  }

  void multiplexing() {
    Extension extension;
    extension.line = line_;
    const auto id = in_.take_number<std::uint32_t>();
    extension.name = in_.take_word();
    extension.selector = in_.take_word();
    bool good = id && is_name(extension.name) && is_name(extension.selector);
    for (bool more = good; good && more; more = in_.take(',')) {
      const auto first = in_.take_number<std::uint64_t>();
      good = first && in_.take('-');
      const auto last = good ? in_.take_number<std::uint64_t>() : std::nullopt;
      good = last && *first <= *last;
      if (good && extension.ranges.size() <= kMaxDbcRanges) {
        extension.ranges.push_back({*first, *last});
      }
    }
    if (!good || !in_.take(';')) return problem(std::string("expected ") + kRangesForm);
    extension.written_id = *id;
    add(std::move(extension));
  }

  void add(Extension extension) {
    if (extensions_.size() == 2 * kMaxSignals) return problem("more statements than signals");
    extensions_.push_back(std::move(extension));
  }

  // When all signals are known: files that people merged have them in any order.
  void extend(const Extension& extension) {
    const auto found = by_name_.find(std::pair(extension.written_id, extension.name));
    line_ = extension.line;
    if (found == by_name_.end()) {
      return problem("speaks of the signal " + extension.name + " of message " +
                     std::to_string(extension.written_id) + ", which the file does not have");
    }
    DbcEntry& entry = file_.signals[found->second];
    if (!extension.ranges.empty()) {
      entry.selector = extension.selector;
      entry.ranges = extension.ranges;
    }
    if (extension.type == 1) entry.signal.value = DbcValue::kFloat32;
    if (extension.type == 2) entry.signal.value = DbcValue::kFloat64;
  }

  void symbols() {
    if (!in_.take(':')) return problem("expected NS_ : and the format's symbols");
    for (DbcScanner before = in_; !in_.rest_is_empty(); before = in_) {
      if (is_symbol_line(in_.take_line())) continue;
      in_ = before;
      return;
    }
  }

  void bit_timing() {
    bool good = in_.take(':');
    if (good && in_.take_number<std::uint32_t>() && in_.take(':')) {
      good = in_.take_number<std::uint32_t>() && in_.take(',') && in_.take_number<std::uint32_t>();
    }
    in_.take(';');
    if (!good) problem("expected the bit timing, BS_: [BAUDRATE : BTR1,BTR2]");
  }

  void nodes() {
    if (!in_.take(':')) return problem("expected the nodes, BU_: NAME NAME ...");
    skip_names(in_);
    in_.take(';');
  }

  void version() {
    const bool good = in_.take_text(TextEnd::kStatement).has_value();
    in_.take(';');
    if (!good) problem("expected VERSION \"TEXT\"");
  }

  // A statement that does not matter here: words, numbers and texts up to its semicolon.
  void pass_over(std::string_view keyword) {
    const TextEnds ends = text_ends(keyword);
    TextEnd end = ends.first;
    bool object = true;  // may come: the kind of thing that a comment or attribute speaks of
    while (!in_.take(';')) {
      if (in_.at('"')) {
        if (!in_.take_text(end)) return problem(unended(keyword));
        object = end != ends.other;
        end = ends.other;
        continue;
      }
      const bool next = in_.begins_line() && is_dbc_keyword(in_.peek_word()) &&
                        !(object && is_object(in_.peek_word()));
      object = false;
      if (next || (in_.take_name().empty() && !in_.take(',') && !in_.take(':'))) {
        return problem("expected ';' at the end of " + std::string(keyword));
      }
    }
  }

  std::string unended(std::string_view keyword) const {
    return "a text of " + std::string(keyword) +
           " has no end, or holds a quote and lines that look like statements: expected a quote "
           "at its end, and \\\" for those inside";
  }

  DbcScanner in_;
  DbcFile file_;
  // The place in `file_` of a message's signal: the first one of that name.
  std::map<std::pair<std::uint32_t, std::string>, std::size_t> by_name_;
  std::vector<Extension> extensions_;
  Message message_;
  bool has_message_ = false;
  int line_ = 0;  // where the statement begins
  std::size_t problem_count_ = 0;
  std::size_t problems_before_ = 0;
  std::string problems_;
};

// Why the bits cannot be read from classic frames; empty when they can.
std::string unusable_bits(const DbcEntry& entry) {
  const DbcSignal& signal = entry.signal;
  const std::uint32_t length = signal.bit_length;
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
  return "";
}

// Why the signal cannot be read; empty when it can.
std::string unusable(const DbcEntry& entry) {
  const DbcSignal& signal = entry.signal;
  const std::uint32_t length = signal.bit_length;
  if (std::string bits = unusable_bits(entry); !bits.empty()) return bits;
  if ((signal.value == DbcValue::kFloat32 && length != 32) ||
      (signal.value == DbcValue::kFloat64 && length != 64)) {
    return "is a float of " + std::to_string(length) + " bits: SIG_VALTYPE_ 1 needs 32, 2 needs 64";
  }
  if (!std::isfinite(signal.scale) || signal.scale == 0.0 || !std::isfinite(signal.offset)) {
    return "has a scale or offset that is zero or no number";
  }
  return "";
}

// The signal that selects the frames of a multiplexed one: what SG_MUL_VAL_ names, or the only "M"
// of the message.
const DbcEntry* selector_of(const DbcFile& file, const DbcEntry& entry) {
  const DbcEntry* found = nullptr;
  for (const DbcEntry& other : file.signals) {
    if (other.written_id != entry.written_id || other.message != entry.message) continue;
    const bool selects = entry.selector.empty()
                             ? other.multiplexing == "M"
                             : other.name == entry.selector && other.multiplexing.ends_with('M');
    if (!selects) continue;
    if (found != nullptr) return nullptr;
    found = &other;
  }
  return found;
}

// The conditions under which the multiplexed signal is in a frame, up to a selector that always is.
Status add_conditions(const DbcFile& file, const DbcEntry& signal, DbcConditions& conditions) {
  const DbcEntry* entry = &signal;
  while (!entry->multiplexing.empty() && entry->multiplexing != "M") {
    const std::string who = "is multiplexed (" + entry->multiplexing + ")";
    const DbcEntry* selector = selector_of(file, *entry);
    if (selector == nullptr) {
      return Error{who + (entry->selector.empty()
                              ? ", expected exactly one selector (M) in its message"
                              : ", but its message has no selector " + entry->selector)};
    }
    const std::string bits = unusable_bits(*selector);
    if (!bits.empty()) return Error{who + ", and its selector " + selector->name + " " + bits};
    DbcCondition condition;
    condition.selector = selector->signal;
    std::vector<DbcRange> ranges = entry->ranges;
    if (ranges.empty()) {
      std::uint64_t number = 0;
      const std::string& text = entry->multiplexing;
      std::from_chars(text.data() + 1, text.data() + text.size(), number);
      ranges.push_back({number, number});
    }
    bool room = true;
    for (const DbcRange& range : ranges) room = room && condition.ranges.push_back(range);
    if (!room) {
      return Error{who + " over more than " + std::to_string(kMaxDbcRanges) +
                   " ranges (SG_MUL_VAL_), which is not supported"};
    }
    if (!conditions.push_back(condition)) {
      return Error{who + " by more than " + std::to_string(DbcConditions::capacity()) +
                   " selectors in a row, which is not supported"};
    }
    entry = selector;
  }
  return {};
}

}  // namespace

Result<DbcFile> parse_dbc(std::string_view text, const std::string& path) {
  return Parser(text, path).parse();
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
  std::string reason = unusable(*found);
  DbcEntry usable = *found;
  if (reason.empty()) {
    const Status selected = add_conditions(file, *found, usable.conditions);
    if (selected) return usable;
    reason = selected.error().message;
  }
  return Error{file.path + ":" + std::to_string(found->line) + ": the signal " + found->message +
               "." + found->name + " " + reason};
}

}  // namespace zenith
