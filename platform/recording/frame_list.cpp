#include "platform/recording/frame_list.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "platform/base/printable.h"
#include "platform/linux/input_file.h"

namespace zenith {
namespace {

// A frame is some 45 bytes of the list.
constexpr LineLimits kLimits = {64 * kMaxListedFrames};

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::optional<ListedFrame> parse_line(std::string_view line) {
  const std::size_t comma = line.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const std::string_view stamp = trim(line.substr(0, comma));
  const std::string_view filename = trim(line.substr(comma + 1));
  ListedFrame frame;
  const char* end = stamp.data() + stamp.size();
  const auto [stop, status] = std::from_chars(stamp.data(), end, frame.stamp.ns);
  if (stamp.empty() || status != std::errc() || stop != end || frame.stamp.ns < 0) {
    return std::nullopt;
  }
  // A name, no way out of the folder.
  if (filename.empty() || filename[0] == '.') return std::nullopt;
  if (filename.find_first_of("/,") != std::string_view::npos) return std::nullopt;
  frame.filename = filename;
  return frame;
}

}  // namespace

Result<std::vector<ListedFrame>> parse_frame_list(InputLines& file) {
  std::vector<ListedFrame> frames;
  std::string_view line;
  while (file.next(line)) {
    if (trim(line).empty() || line[0] == '#') continue;
    auto frame = parse_line(line);
    if (!frame) {
      return file.error("expected 'nanoseconds,filename', found '" + printable_start(line, 80) +
                        "'");
    }
    if (frames.size() == kMaxListedFrames) {
      return file.error("expected at most " + std::to_string(kMaxListedFrames) +
                        " frames; record a long drive in parts");
    }
    if (!frames.empty() && frame->stamp <= frames.back().stamp) {
      return file.error("the stamp " + std::to_string(frame->stamp.ns) +
                        " does not follow the one before, " +
                        std::to_string(frames.back().stamp.ns));
    }
    frame->line = static_cast<int>(file.number());
    frames.push_back(std::move(*frame));
  }
  if (!file.status()) return file.status().error();
  if (frames.empty()) return Error{file.name() + ": lists no frame"};
  return frames;
}

Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& path) {
  auto file = InputLines::open(path.string(), kLimits);
  if (!file) return file.error();
  return parse_frame_list(*file);
}

}  // namespace zenith
