#include "tests/unit/ros2/type_hash.h"

#include <sodium.h>

#include <array>
#include <map>
#include <regex>
#include <set>
#include <vector>

#include "tests/unit/tools/temporary_folder.h"

namespace zenith::ros2 {
namespace {

struct Field {
  std::string name;
  int type = 0;  // ROS 2's number, without the offset of lists
  std::string nested;
  int count = 0;  // of an array; -1: a sequence
};

// REP-2011's numbers of the types that IDL calls so.
const std::map<std::string, int> kNumbers = {{"uint8", 3},  {"long", 6},    {"unsigned long", 7},
                                             {"float", 10}, {"double", 11}, {"boolean", 15},
                                             {"octet", 16}, {"string", 17}};

// "geometry_msgs::msg::dds_::Point_" and "Point_" -> "geometry_msgs/msg/Point"
std::string ros_type(const std::string& idl, const std::string& package) {
  const std::size_t colon = idl.find("::");
  const std::string owner = colon == std::string::npos ? package : idl.substr(0, colon);
  std::string name = idl.substr(idl.rfind(':') == std::string::npos ? 0 : idl.rfind(':') + 1);
  name.pop_back();  // the underscore
  return owner + "/msg/" + name;
}

Field field_of(const std::smatch& match, const std::string& package) {
  Field field;
  std::string type = match[1];
  field.name = match[2];
  std::smatch part;
  if (std::regex_match(type, part, std::regex("sequence<(.*)>"))) {
    field.count = -1;
    type = std::string(part[1]);
  }
  if (match[3].matched) field.count = std::stoi(match[3]);
  const auto number = kNumbers.find(type);
  field.type = number == kNumbers.end() ? 1 : number->second;
  if (number == kNumbers.end()) field.nested = ros_type(type, package);
  return field;
}

std::vector<Field> fields_of(const std::string& folder, const std::string& type) {
  const std::string package = type.substr(0, type.find('/'));
  const std::string name = type.substr(type.rfind('/') + 1);
  const std::string text = tools::read_text(folder + "/" + package + ".idl");
  const std::size_t begin = text.find("struct " + name + "_ {");
  if (begin == std::string::npos) return {};
  const std::string body = text.substr(begin, text.find("};", begin) - begin);
  std::vector<Field> fields;
  const std::regex line(R"(\n  ([A-Za-z0-9_:<> ]+) ([a-z_0-9]+)(?:\[([0-9]+)\])?;)");
  for (std::sregex_iterator at(body.begin(), body.end(), line), end; at != end; ++at) {
    fields.push_back(field_of(*at, package));
  }
  return fields;
}

// As Python's json writes it; `needed` gets the nested types.
std::string description(const std::string& folder, const std::string& type,
                        std::set<std::string>& needed) {
  std::string out = R"({"type_name": ")" + type + R"(", "fields": [)";
  bool first = true;
  for (const Field& f : fields_of(folder, type)) {
    const int number = f.type + (f.count > 0 ? 48 : f.count < 0 ? 144 : 0);
    out += (first ? "" : ", ") + std::string(R"({"name": ")") + f.name + R"(", "type": {)" +
           R"("type_id": )" + std::to_string(number) + R"(, "capacity": )" +
           std::to_string(std::max(f.count, 0)) +
           R"(, "string_capacity": 0, "nested_type_name": ")" + f.nested + "\"}}";
    first = false;
    if (f.nested.empty() || !needed.insert(f.nested).second) continue;
    description(folder, f.nested, needed);
  }
  return out + "]}";
}

}  // namespace

std::string type_hash(const std::string& folder, const std::string& type) {
  std::set<std::string> needed;
  std::string text = R"({"type_description": )" + description(folder, type, needed) +
                     R"(, "referenced_type_descriptions": [)";
  bool first = true;
  for (const std::string& nested : needed) {
    std::set<std::string> again;
    text += (first ? "" : ", ") + description(folder, nested, again);
    first = false;
  }
  text += "]}";
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash;
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size());
  std::string out = "RIHS01_";
  for (const unsigned char byte : hash) {
    constexpr char kDigits[] = "0123456789abcdef";
    out += {kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return out;
}

}  // namespace zenith::ros2
