#include "tools/view/kept_lines.h"

#include "platform/base/base64.h"

namespace zenith::tools {

using nlohmann::json;

std::string KeptLines::take(const RobotState& state, const TelemetryLine& line,
                            std::string_view text, Time now) {
  if (line.as<PictureLine>() == nullptr && line.as<StripLine>() == nullptr) {
    return std::string(text);
  }
  const auto& picture = state.picture();
  if (!picture || picture->serial == picture_ || now < next_picture_) return "";
  picture_ = picture->serial;
  next_picture_ = now + picture_every_;
  json whole = picture->told;
  std::string jpeg(base64_size(picture->jpeg.size()), ' ');
  write_base64(picture->jpeg, jpeg.data());
  whole["jpeg"] = std::move(jpeg);
  return whole.dump();
}

}  // namespace zenith::tools
