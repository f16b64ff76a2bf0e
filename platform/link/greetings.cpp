#include "platform/link/greetings.h"

namespace zenith {
namespace {

using exchange::SectionType;

bool read_name(exchange::Bytes body, std::uint64_t robot, std::optional<RobotName>& out) {
  exchange::Hello hello;
  if (!decode(body, hello) || robot_id(hello.text()) != robot) return false;
  out.emplace(hello.text());
  return true;
}

}  // namespace

bool read_greetings(exchange::Bytes payload, std::uint64_t robot, Greetings& out) {
  exchange::SectionReader sections(payload);
  exchange::Section section;
  bool good = true;
  while (good && sections.next(section)) {
    if (section.is(SectionType::kHello)) {
      good = read_name(section.body, robot, out.name);
    } else if (section.is(SectionType::kChallenge)) {
      good = decode(section.body, out.challenge.emplace());
    } else if (section.is(SectionType::kResponse)) {
      good = decode(section.body, out.response.emplace());
    } else if (section.is(SectionType::kBye)) {
      good = out.bye = section.body.empty();
    }
  }
  return good && !sections.malformed();
}

}  // namespace zenith
