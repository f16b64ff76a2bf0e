#include "platform/recording/can_log.h"

#include "platform/recording/candump.h"

namespace zenith {

namespace {

// A frame is some 45 bytes of the log, and other interfaces' stand there too.
constexpr LineLimits kLimits = {128 * kMaxLoggedFrames};

}  // namespace

Result<CanLog> parse_can_log(InputLines& file, const std::string& interface) {
  CanLog log;
  std::string_view line;
  while (file.next(line)) {
    CanFrame frame;
    std::string_view name;
    switch (parse_candump(line, frame, name)) {
      case CandumpLine::kMalformed:
        if (log.malformed++ == 0) log.first_malformed = file.place();
        break;
      case CandumpLine::kOther:
        log.other_frames += line.empty() ? 0 : 1;
        break;
      case CandumpLine::kFrame:
        if (name != interface) {
          ++log.other_interfaces;
          break;
        }
        if (log.frames.size() == kMaxLoggedFrames) {
          return file.error("expected at most " + std::to_string(kMaxLoggedFrames) + " frames of " +
                            interface + "; record a long drive in parts");
        }
        log.frames.push_back(frame);
        break;
    }
  }
  if (!file.status()) return file.status().error();
  return log;
}

Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_can_log(*file, interface);
}

}  // namespace zenith
