#include "platform/recording/can_log.h"

#include "platform/recording/candump.h"
#include "platform/recording/text_file.h"

namespace zenith {

Result<CanLog> read_can_log(const std::filesystem::path& path, const std::string& interface) {
  auto file = TextFile::open(path);
  if (!file.ok()) return file.error();
  CanLog log;
  std::string line;
  while (file->next(line)) {
    CanFrame frame;
    std::string_view name;
    switch (parse_candump(line, frame, name)) {
      case CandumpLine::kMalformed:
        if (log.malformed++ == 0) log.first_malformed = file->place();
        break;
      case CandumpLine::kOther:
        log.other_frames += line.empty() ? 0 : 1;
        break;
      case CandumpLine::kFrame:
        if (name == interface) {
          log.frames.push_back(frame);
        } else {
          ++log.other_interfaces;
        }
        break;
    }
  }
  return log;
}

}  // namespace zenith
