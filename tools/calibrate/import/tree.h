#pragma once
// What calibration files have in common, whatever they are written in: keys with texts, lists and
// further keys below them. YAML, JSON and XML become such trees; the readers of the formats
// (keyed_formats.h) know trees alone.
//
// A tree is small: at most kMostNodes nodes, kMostDepth deep. A file that needs more is an error,
// not a crash, and aliases of YAML count as what they stand for.

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"

namespace zenith::tools {

struct Node {
  enum class Kind : unsigned char { kScalar, kList, kMap };

  Kind kind = Kind::kScalar;
  std::string key;   // in a map
  std::string text;  // of a scalar; empty for YAML's null
  std::vector<Node> children;

  bool is_scalar() const { return kind == Kind::kScalar; }
  bool is_list() const { return kind == Kind::kList; }
  bool is_map() const { return kind == Kind::kMap; }
};

inline constexpr std::size_t kMostNodes = 200'000;
inline constexpr std::size_t kMostDepth = 32;

// Makes a tree from the events of a parser, which come as the file has them.
class TreeBuilder {
 public:
  // Each false when the tree grows too large: nothing of it can be used then.
  bool begin(Node::Kind kind);
  bool end();
  bool scalar(std::string text);
  bool key(std::string text);
  // A whole subtree, as an alias.
  bool insert(const Node& node);

  // Whether the next scalar of a map is a key: YAML does not tell them apart.
  bool expects_key() const { return !open_.empty() && open_.back().is_map() && !has_key_; }
  const Node& root() const { return root_; }
  // The node that was completed last; valid until the next call.
  const Node& last() const;

 private:
  bool add(Node node);

  Node root_;
  std::vector<Node> open_;
  std::string key_;
  bool has_key_ = false;
  std::size_t nodes_ = 0;
};

// The documents of a file; several only in YAML. An error at a later one leaves the earlier ones:
// `broken` says where it is then.
struct Documents {
  std::vector<Node> roots;
  std::string broken;
};
Result<Documents> parse_yaml_tree(std::string_view text);
Result<Documents> parse_json_tree(std::string_view text);
Result<Documents> parse_xml_tree(std::string_view text);

// "Camera_Matrix", "cameraMatrix", "camera.matrix" -> "cameramatrix".
std::string plain_key(std::string_view key);

// The child of a map whose plain key is one of `names`: of the first name that is there. None for
// what is no map. Names must be plain.
const Node* find(const Node& map, std::initializer_list<std::string_view> names);

// All numbers of a scalar ("1, 2 3", "[1 2]"), of a list, also of lists in it, or of a matrix with
// its numbers below `data`. An error for what is no number; not finite ones are numbers here.
Result<std::vector<double>> numbers_of(const Node& node);

// The same of a text.
Result<std::vector<double>> numbers_in(std::string_view text);

// Without spaces at both ends.
std::string_view trimmed(std::string_view text);
std::string lower(std::string_view text);

}  // namespace zenith::tools
