// YAML by yaml-cpp, JSON by nlohmann's parser, and the XML that OpenCV writes. The first two call
// back for what they find, so no tree of theirs is made and depth is limited before it grows.

#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/parser.h>
#include <yaml-cpp/yaml.h>
#include <nlohmann/json.hpp>

#include "platform/base/printable.h"
#include "tools/calibrate/import/tree.h"

namespace zenith::tools {
namespace {

constexpr const char* kTooLarge =
    "nested deeper than 32 levels, or more than 200000 values: no calibration is like that";

std::string at_line(std::size_t line, const std::string& what) {
  return "line " + std::to_string(line) + ": " + what;
}

constexpr int kMostDocuments = 1000;

// --- YAML ---------------------------------------------------------------------------------------

struct TooLarge : std::runtime_error {
  TooLarge() : std::runtime_error(kTooLarge) {}
};

class YamlEvents : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {
    builder_ = {};
    anchors_.clear();
    open_anchors_.clear();
    any_ = false;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t anchor) override { scalar("", anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    any_ = true;
    const auto named = anchors_.find(anchor);
    if (named == anchors_.end() || builder_.expects_key()) {
      throw YAML::ParserException(mark, "an alias that stands for nothing");
    }
    check(builder_.insert(named->second));
  }
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& value) override {
    scalar(value, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    begin(mark, Node::Kind::kList, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    begin(mark, Node::Kind::kMap, anchor);
  }
  void OnMapEnd() override { end(); }

  bool any() const { return any_; }
  const Node& root() const { return builder_.root(); }

 private:
  static void check(bool small) {
    if (!small) throw TooLarge();
  }
  void scalar(const std::string& text, YAML::anchor_t anchor) {
    any_ = true;
    if (builder_.expects_key()) {
      check(builder_.key(text));
      return;
    }
    check(builder_.scalar(text));
    if (anchor != 0) anchors_[anchor] = builder_.last();
  }
  void begin(const YAML::Mark& mark, Node::Kind kind, YAML::anchor_t anchor) {
    any_ = true;
    if (builder_.expects_key()) {
      throw YAML::ParserException(mark, "a key that is a list or a map");
    }
    check(builder_.begin(kind));
    open_anchors_.push_back(anchor);
  }
  void end() {
    check(builder_.end());
    const YAML::anchor_t anchor = open_anchors_.back();
    open_anchors_.pop_back();
    if (anchor != 0) anchors_[anchor] = builder_.last();
  }

  TreeBuilder builder_;
  std::map<YAML::anchor_t, Node> anchors_;
  std::vector<YAML::anchor_t> open_anchors_;
  bool any_ = false;
};

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '.' || c == '-';
}

// Where "key:value" lacks the space that YAML wants and OpenCV's writers and people forget; npos
// for all else.
std::size_t missing_space(std::string_view line) {
  std::size_t at = line.find_first_not_of(" -");
  if (at == line.npos) return line.npos;
  const std::size_t begin = at;
  while (at < line.size() && is_word(line[at])) ++at;
  if (at == begin || at + 1 >= line.size() || line[at] != ':') return line.npos;
  const char next = line[at + 1];
  return next == ' ' || next == '\r' || next == '/' || next == ':' ? line.npos : at + 1;
}

// YAML as OpenCV and people write it, for a strict parser: without directives ("%YAML:1.0"), tabs
// as spaces, a space behind each key.
std::string strict_yaml(std::string_view text) {
  std::string out;
  out.reserve(text.size() + 256);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string line(text.substr(0, end));
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    if (line.starts_with('%')) line.clear();
    // What `ros2 topic echo` prints between messages: three lines, the last with "---" at its end.
    if (line.starts_with("A message was lost")) line.clear();
    if (trimmed(line).starts_with("total count")) line = line.ends_with("---") ? "---" : "";
    for (std::size_t tab = line.find('\t'); tab != line.npos; tab = line.find('\t', tab)) {
      line.replace(tab, 1, "    ");
    }
    if (const std::size_t space = missing_space(line); space != line.npos) {
      line.insert(space, 1, ' ');
    }
    out += line;
    out += '\n';
  }
  return out;
}

// yaml-cpp looks ahead as far as brackets are open, before it says that any began.
bool opens_too_many(std::string_view text) {
  std::size_t open = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++open;
    if ((c == ']' || c == '}') && open > 0) --open;
    if (open > 16 * kMostDepth) return true;
  }
  return false;
}

// YAML's "<<: *other": the other map's keys, where the map does not have them itself.
void merge_keys(Node& node) {
  for (Node& child : node.children) merge_keys(child);
  const auto is_merge = [](const Node& child) { return child.key == "<<" && !child.is_scalar(); };
  const auto at = std::find_if(node.children.begin(), node.children.end(), is_merge);
  if (!node.is_map() || at == node.children.end()) return;
  const Node merged = std::move(*at);
  node.children.erase(at);
  const auto take = [&node](const Node& other) {
    for (const Node& entry : other.children) {
      const bool known = std::any_of(node.children.begin(), node.children.end(),
                                     [&](const Node& own) { return own.key == entry.key; });
      if (!known) node.children.push_back(entry);
    }
  };
  if (merged.is_map()) return take(merged);
  for (const Node& other : merged.children) {
    if (other.is_map()) take(other);
  }
}

Result<Documents> parse_yaml(const std::string& text) {
  if (opens_too_many(text)) return Error{kTooLarge};
  Documents documents;
  YamlEvents events;
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    // yaml-cpp finds documents without an end behind bytes that are no text.
    for (int i = 0; i < kMostDocuments && parser.HandleNextDocument(events); ++i) {
      if (!events.any()) continue;
      documents.roots.push_back(events.root());
      merge_keys(documents.roots.back());
    }
  } catch (const YAML::Exception& error) {
    documents.broken =
        at_line(static_cast<std::size_t>(error.mark.line) + 1, printable_start(error.msg, 200));
  } catch (const std::exception& error) {
    documents.broken = error.what();
  }
  if (documents.roots.empty() && !documents.broken.empty()) return Error{documents.broken};
  return documents;
}

// --- JSON ---------------------------------------------------------------------------------------

class JsonEvents {
 public:
  using json = nlohmann::json;

  bool null() { return builder_.scalar({}); }
  bool boolean(bool value) { return builder_.scalar(value ? "true" : "false"); }
  bool number_integer(std::int64_t value) { return builder_.scalar(std::to_string(value)); }
  bool number_unsigned(std::uint64_t value) { return builder_.scalar(std::to_string(value)); }
  bool number_float(double /*value*/, const std::string& text) { return builder_.scalar(text); }
  bool string(std::string& text) { return builder_.scalar(text); }
  bool binary(json::binary_t& /*bytes*/) { return false; }
  bool start_object(std::size_t /*size*/) { return builder_.begin(Node::Kind::kMap); }
  bool end_object() { return builder_.end(); }
  bool start_array(std::size_t /*size*/) { return builder_.begin(Node::Kind::kList); }
  bool end_array() { return builder_.end(); }
  bool key(std::string& text) { return builder_.key(text); }
  bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) {
    wrong_ = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, ..."
    if (const std::size_t end = wrong_.find("] "); end != wrong_.npos) wrong_.erase(0, end + 2);
    return false;
  }

  const Node& root() const { return builder_.root(); }
  const std::string& wrong() const { return wrong_; }

 private:
  TreeBuilder builder_;
  std::string wrong_;
};

// --- XML ----------------------------------------------------------------------------------------

// The elements and texts of OpenCV's FileStorage: no attributes, no CDATA, no entities of one's
// own.
class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : text_(text) {}

  Result<Documents> read() {
    std::vector<Element> open(1);
    std::size_t nodes = 0;
    while (at_ < text_.size()) {
      const std::size_t next = std::min(text_.find('<', at_), text_.size());
      open.back().text += text_.substr(at_, next - at_);
      at_ = next;
      if (at_ == text_.size()) break;
      if (text_.substr(at_).starts_with("<!--")) {
        if (!skip_to("-->")) return error("a comment without its end");
        continue;
      }
      const std::size_t end = text_.find('>', at_);
      if (end == text_.npos) return error("a tag without its '>'");
      const std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
      if (tag.starts_with('?') || tag.starts_with('!')) {
        at_ = end + 1;
        continue;
      }
      if (tag.starts_with('/')) {
        if (open.size() < 2 || trimmed(tag.substr(1)) != open.back().node.key) {
          return error("</" + printable_start(trimmed(tag.substr(1)), 40) + "> closes nothing");
        }
        close(open);
      } else {
        const bool empty = tag.ends_with('/');
        open.push_back({});
        open.back().node.key = tag.substr(0, tag.find_first_of(" \t\r\n/"));
        if (open.back().node.key.empty()) return error("a tag without a name");
        if (open.size() > kMostDepth || ++nodes > kMostNodes) return Error{kTooLarge};
        if (empty) close(open);
      }
      at_ = end + 1;
    }
    if (open.size() != 1)
      return error("<" + printable_start(open.back().node.key, 40) + "> is never closed");
    Documents documents;
    documents.roots = std::move(open.front().node.children);
    return documents;
  }

 private:
  struct Element {
    Node node;
    std::string text;
  };

  // An element with elements is a map, or OpenCV's list of <_>; all else is a text.
  static void close(std::vector<Element>& open) {
    Element done = std::move(open.back());
    open.pop_back();
    Node& node = done.node;
    if (node.children.empty()) {
      std::string_view text = trimmed(done.text);
      if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
        text = text.substr(1, text.size() - 2);
      }
      node.text = text;
    } else {
      node.kind = node.children.front().key == "_" ? Node::Kind::kList : Node::Kind::kMap;
    }
    open.back().node.children.push_back(std::move(node));
  }
  bool skip_to(std::string_view mark) {
    const std::size_t end = text_.find(mark, at_);
    if (end == text_.npos) return false;
    at_ = end + mark.size();
    return true;
  }
  Error error(const std::string& what) const {
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<long>(at_), '\n');
    return {at_line(static_cast<std::size_t>(lines) + 1, what)};
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

Result<Documents> parse_yaml_tree(std::string_view text) {
  return parse_yaml(strict_yaml(text));
}

Result<Documents> parse_json_tree(std::string_view text) {
  JsonEvents events;
  const bool whole = nlohmann::json::sax_parse(text.begin(), text.end(), &events,
                                               nlohmann::json::input_format_t::json,
                                               /*strict=*/true, /*ignore_comments=*/true);
  if (!whole)
    return Error{events.wrong().empty() ? kTooLarge : printable_start(events.wrong(), 240)};
  return Documents{{events.root()}, {}};
}

Result<Documents> parse_xml_tree(std::string_view text) {
  return XmlReader(text).read();
}

}  // namespace zenith::tools
