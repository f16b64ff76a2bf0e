// Which format a file has, and where in it lenses are.

#include "tools/calibrate/import/foreign_lens.h"

#include <algorithm>
#include <array>

#include "platform/base/printable.h"
#include "platform/linux/input_file.h"
#include "tools/calibrate/import/formats.h"
#include "tools/calibrate/import/tree.h"

namespace zenith::tools {
namespace {

constexpr std::array<KeyedReader, 7> kReaders = {read_basalt,     read_camodocal, read_svo,
                                                 read_kalibr,     read_okvis,     read_plain_keys,
                                                 read_nested_keys};
constexpr std::size_t kMostLenses = 64;

// Sizes and names stand beside lists of cameras as well: {"intrinsics": [..], "resolution": [..]}.
Node basalt_camera(const Node& values, const Node& camera, std::size_t index) {
  Node out = camera;
  const Node* sizes = find(values, {"resolution"});
  if (sizes == nullptr || find(camera, {"resolution"}) != nullptr) return out;
  const bool of_all =
      sizes->is_list() && !sizes->children.empty() && sizes->children.front().is_scalar();
  if (of_all) {
    out.children.push_back(*sizes);
  } else if (index < sizes->children.size()) {
    out.children.push_back(sizes->children[index]);
  } else {
    return out;
  }
  out.children.back().key = "resolution";
  return out;
}

// "Camera.fx: 1" -> "Camera: {fx: 1}", for those keys that have a point.
Node without_points(const Node& map) {
  Node out{Node::Kind::kMap, map.key, {}, {}};
  for (const Node& child : map.children) {
    const std::size_t point = child.key.find('.');
    if (point == child.key.npos || point == 0 || point + 1 == child.key.size()) {
      out.children.push_back(child);
      continue;
    }
    const std::string group = child.key.substr(0, point);
    auto into = std::find_if(out.children.begin(), out.children.end(),
                             [&](const Node& node) { return node.is_map() && node.key == group; });
    if (into == out.children.end()) {
      if (out.children.size() > kMostLenses * 64) continue;
      out.children.push_back({Node::Kind::kMap, group, {}, {}});
      into = out.children.end() - 1;
    }
    Node entry = child;
    entry.key = child.key.substr(point + 1);
    into->children.push_back(std::move(entry));
  }
  return out;
}

// ORB-SLAM's Camera1 and Camera2 share the size that stands under Camera.
void share_size(Node& map) {
  const auto is_size = [](const Node& node) {
    const std::string plain = plain_key(node.key);
    return plain == "width" || plain == "height" || plain == "type";
  };
  for (const Node& group : std::vector<Node>(map.children)) {
    if (!group.is_map() || group.key != "Camera") continue;
    for (Node& other : map.children) {
      if (!other.is_map() || (other.key != "Camera1" && other.key != "Camera2")) continue;
      for (const Node& entry : group.children) {
        if (is_size(entry) && find(other, {plain_key(entry.key)}) == nullptr) {
          other.children.push_back(entry);
        }
      }
    }
  }
}

bool same(const Node& a, const Node& b) {
  return a.kind == b.kind && a.key == b.key && a.text == b.text &&
         std::equal(a.children.begin(), a.children.end(), b.children.begin(), b.children.end(),
                    same);
}

// A key that stands twice in a camera's map, or in those below it, and does not say the same.
std::string doubled_key(const Node& map, int depth = 0) {
  if (map.children.size() > 500) return {};
  for (std::size_t i = 0; i < map.children.size(); ++i) {
    const Node& child = map.children[i];
    for (std::size_t j = 0; map.is_map() && j < i; ++j) {
      if (map.children[j].key == child.key && !same(map.children[j], child)) return child.key;
    }
    if (child.is_map() && depth < 3) {
      std::string below = doubled_key(child, depth + 1);
      if (!below.empty()) return below;
    }
  }
  return {};
}

void refuse_doubled(const Node& map, ForeignLens& lens) {
  const std::string key = doubled_key(map);
  if (key.empty() || !lens.refused.empty()) return;
  lens.refused = "the key " + printable_start(key, 40) +
                 " stands twice, with different values: leave the right one";
}

void search(const Node& node, const std::string& name, ForeignModel wanted, ForeignLenses& out) {
  if (out.size() >= kMostLenses || node.is_scalar()) return;
  if (node.is_list()) {
    for (std::size_t i = 0; i < node.children.size(); ++i) {
      if (node.children[i].is_scalar()) return;
      search(node.children[i], name + "[" + std::to_string(i) + "]", wanted, out);
    }
    return;
  }
  for (const KeyedReader reader : kReaders) {
    if (auto lens = reader(node, name, wanted)) {
      refuse_doubled(node, *lens);
      out.push_back(std::move(*lens));
      return;
    }
  }
  ForeignLenses of_matrices = read_matrices(node, name, wanted);
  for (ForeignLens& lens : of_matrices) refuse_doubled(node, lens);
  out.insert(out.end(), of_matrices.begin(), of_matrices.end());
  if (!of_matrices.empty()) return;
  const Node* cameras = find(node, {"intrinsics"});
  const bool basalt = cameras != nullptr && cameras->is_list();
  if (basalt) {
    for (std::size_t i = 0; i < cameras->children.size(); ++i) {
      search(basalt_camera(node, cameras->children[i], i), "cam" + std::to_string(i), wanted, out);
    }
    if (!out.empty()) return;
  }
  if (cameras != nullptr && cameras->is_map() && find(*cameras, {"cameratype"}) != nullptr) {
    return search(basalt_camera(node, *cameras, 0), "cam0", wanted, out);
  }
  for (const Node& child : node.children) {
    const bool plain_parent = name.empty() || name == "value0" || name == "ros__parameters";
    search(child, plain_parent ? child.key : name + "." + child.key, wanted, out);
  }
}

// A message that repeats itself, as a topic does, is one camera.
void remove_repeated(ForeignLenses& lenses) {
  ForeignLenses once;
  for (ForeignLens& lens : lenses) {
    const bool known = std::any_of(once.begin(), once.end(), [&lens](const ForeignLens& other) {
      return other.camera == lens.camera && other.lens == lens.lens &&
             other.refused == lens.refused && other.skew_px == lens.skew_px;
    });
    if (!known) once.push_back(std::move(lens));
  }
  lenses = std::move(once);
}

// Each camera's name chooses it.
void name_apart(ForeignLenses& lenses) {
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    std::string& name = lenses[i].camera;
    name = printable_start(name, 60);
    const auto same = [&](const ForeignLens& other) { return other.camera == name; };
    const auto end = lenses.begin() + static_cast<std::ptrdiff_t>(i);
    if (lenses.size() > 1 && (name.empty() || std::any_of(lenses.begin(), end, same))) {
      name += (name.empty() ? "camera" : "-") + std::to_string(i);
    }
  }
}

Result<Documents> parse_tree(std::string_view text) {
  const std::string_view start = trimmed(text);
  if (start.starts_with('<')) return parse_xml_tree(text);
  if (start.starts_with('{') || start.starts_with('[')) {
    auto json = parse_json_tree(text);
    // YAML has braces as well, and is not as strict.
    if (json || start.starts_with("{\n  \"") || start.starts_with("{\"")) return json;
    auto yaml = parse_yaml_tree(text);
    return yaml ? std::move(yaml) : std::move(json);
  }
  return parse_yaml_tree(text);
}

// Lines as they end on this system.
std::string plain_lines(std::string text) {
  for (std::size_t at = text.find('\r'); at != text.npos; at = text.find('\r', at + 1)) {
    text[at] = '\n';
    if (at + 1 < text.size() && text[at + 1] == '\n') text[at] = ' ';
  }
  return text;
}

// What a person meets who downloads a file in the wrong way; empty: something else.
std::string no_calibration_but(std::string_view text) {
  const std::string start = lower(trimmed(text).substr(0, 64));
  if (start.starts_with("<!doctype html") || start.starts_with("<html")) {
    return "found a web page; download the file itself (on GitHub: Raw)";
  }
  if (start.starts_with("version https://git-lfs")) {
    return "found a pointer of Git LFS in place of the file; fetch it with git lfs pull";
  }
  if (text.find('\0') != text.npos) {
    return "found a binary file; COLMAP writes text with model_converter --output_type TXT, arrays "
           "of Python can be saved as YAML or JSON";
  }
  return {};
}

// The first keys of a file, for a person to see what was looked at.
std::string first_keys(const Documents& documents) {
  constexpr std::size_t kMostKeys = 8;
  std::vector<std::string> keys;
  for (const Node& root : documents.roots) {
    for (const Node& child : root.children) {
      if (child.key.empty()) continue;
      keys.push_back(child.key);
      for (const Node& below : child.children) {
        if (child.is_map()) keys.push_back(child.key + "." + below.key);
      }
    }
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(keys.size(), kMostKeys); ++i) {
    text += (text.empty() ? "" : ", ") + printable_start(keys[i], 40);
  }
  return keys.size() > kMostKeys ? text + ", .." : text;
}

Error nothing_found(const std::string& name, const std::string& files, const std::string& keys) {
  return {name +
          ": expected a calibration of Kalibr, ROS (camera_info, ost.txt), OpenCV, Basalt, "
          "camodocal (VINS), ORB-SLAM, OCamCalib, SVO, OKVIS, MRPT, COLMAP or DSO, found none of "
          "their keys" +
          (keys.empty() ? "" : " but " + keys) +
          (files.empty() ? "" : "; it names " + files + ": give that file")};
}

}  // namespace

ForeignLenses find_lenses(const Documents& documents, ForeignModel wanted) {
  ForeignLenses lenses;
  for (const Node& root : documents.roots) {
    Node tree = root.is_map() ? without_points(root) : root;
    share_size(tree);
    search(tree, "", wanted, lenses);
  }
  remove_repeated(lenses);
  return lenses;
}

std::string named_files(const Documents& documents) {
  std::string names;
  std::size_t count = 0;
  for (const Node& root : documents.roots) {
    for (const Node& child : root.children) {
      const std::string key = plain_key(child.key);
      const bool about_cameras = key.find("cam") != key.npos || key.find("calib") != key.npos;
      const bool file = child.text.ends_with(".yaml") || child.text.ends_with(".yml") ||
                        child.text.ends_with(".json") || child.text.ends_with(".xml");
      if (!child.is_scalar() || !about_cameras || !file || ++count > 4) continue;
      names += (names.empty() ? "" : ", ") + printable_start(child.text, 80);
    }
  }
  return names;
}

Result<ForeignLenses> parse_foreign_lenses(const std::string& file, const std::string& name,
                                           ForeignModel model) {
  const std::string text = plain_lines(file);
  ForeignLenses lenses;
  std::string files;
  std::string keys;
  if (const std::string other = no_calibration_but(text); !other.empty()) {
    return Error{name + ": expected a calibration, " + other};
  }
  if (auto plain = read_plain_text(text, model)) {
    if (!*plain) return Error{name + ": " + plain->error().message};
    lenses = std::move(**plain);
  } else {
    const auto documents = parse_tree(text);
    if (!documents) return Error{name + ": " + documents.error().message};
    lenses = find_lenses(*documents, model);
    if (lenses.empty() && !documents->broken.empty()) return Error{name + ": " + documents->broken};
    files = named_files(*documents);
    keys = first_keys(*documents);
  }
  if (lenses.empty()) return nothing_found(name, files, keys);
  name_apart(lenses);
  return lenses;
}

Result<ForeignLenses> read_foreign_lenses(const std::filesystem::path& path, ForeignModel model) {
  const auto text = read_text_input(path.string(), kMaxCalibrationBytes);
  if (!text) return text.error();
  return parse_foreign_lenses(*text, path.string(), model);
}

}  // namespace zenith::tools
