// The types of Foxglove's that are used, as JSON Schema: https://docs.foxglove.dev/docs/sdk/schemas

#include <nlohmann/json.hpp>

#include "tools/view/foxglove_session.h"

namespace zenith::tools {
namespace {

using nlohmann::json;

json object(const json& properties) {
  return {{"type", "object"}, {"properties", properties}};
}
json list(const json& items) {
  return {{"type", "array"}, {"items", items}};
}

const json kNumber = {{"type", "number"}};
const json kInteger = {{"type", "integer"}};
const json kText = {{"type", "string"}};
const json kYesNo = {{"type", "boolean"}};

json numbers(std::initializer_list<const char*> names) {
  json properties;
  for (const char* name : names) properties[name] = kNumber;
  return object(properties);
}

json time() {
  return object({{"sec", kInteger}, {"nsec", kInteger}});
}
json pose() {
  return object(
      {{"position", numbers({"x", "y", "z"})}, {"orientation", numbers({"x", "y", "z", "w"})}});
}
json colour() {
  return numbers({"r", "g", "b", "a"});
}

json frame_transform() {
  return object({{"timestamp", time()},
                 {"parent_frame_id", kText},
                 {"child_frame_id", kText},
                 {"translation", numbers({"x", "y", "z"})},
                 {"rotation", numbers({"x", "y", "z", "w"})}});
}

json compressed_image() {
  return object({{"timestamp", time()},
                 {"frame_id", kText},
                 {"data", {{"type", "string"}, {"contentEncoding", "base64"}}},
                 {"format", kText}});
}

json scene_update() {
  const json sphere =
      object({{"pose", pose()}, {"size", numbers({"x", "y", "z"})}, {"color", colour()}});
  const json line = object({{"type", kInteger},
                            {"pose", pose()},
                            {"thickness", kNumber},
                            {"scale_invariant", kYesNo},
                            {"points", list(numbers({"x", "y", "z"}))},
                            {"color", colour()},
                            {"colors", list(colour())},
                            {"indices", list(kInteger)}});
  json entity = {{"timestamp", time()}, {"frame_id", kText},      {"id", kText},
                 {"lifetime", time()},  {"frame_locked", kYesNo}, {"spheres", list(sphere)},
                 {"lines", list(line)}};
  for (const char* unused :
       {"metadata", "arrows", "cubes", "cylinders", "triangles", "texts", "models"}) {
    entity[unused] = list({{"type", "object"}});
  }
  return object(
      {{"deletions", list(object({{"timestamp", time()}, {"type", kInteger}, {"id", kText}}))},
       {"entities", list(object(entity))}});
}

}  // namespace

std::string foxglove_schema(const std::string& name) {
  json schema = name == "foxglove.SceneUpdate"      ? scene_update()
                : name == "foxglove.FrameTransform" ? frame_transform()
                                                    : compressed_image();
  schema["title"] = name;
  return schema.dump();
}

}  // namespace zenith::tools
