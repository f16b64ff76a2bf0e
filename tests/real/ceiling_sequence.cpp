#include "tests/real/ceiling_sequence.h"

#include <cstdio>
#include <numbers>
#include <string>

#include <opencv2/core/persistence.hpp>

#include "tests/support/grey_image.h"

namespace zenith {
namespace {

// The lens leans towards the image's columns: a pitch forward, in the mount's convention.
void read_camera(const cv::FileNode& camera, const cv::FileNode& mount, CeilingSequence& out) {
  Lens& lens = out.robot.lens;
  lens.fu_px = camera["fx"].real();
  lens.fv_px = camera["fy"].real();
  lens.cu_px = camera["cx"].real();
  lens.cv_px = camera["cy"].real();
  lens.k = {camera["k1"].real(), 0.0, 0.0, 0.0};
  lens.width_px = static_cast<int>(camera["width"].real());
  lens.height_px = static_cast<int>(camera["height"].real());
  out.tilt_deg = mount["pitch_deg"].real();
  out.robot.mount.pitch_rad = out.tilt_deg * std::numbers::pi / 180.0;
}

}  // namespace

Result<CeilingSequence> load_ceiling_sequence(const std::filesystem::path& folder) {
  CeilingSequence sequence;
  const std::string file = (folder / "camera.json").string();
  if (!std::filesystem::exists(file)) return Error{"there is no " + file};
  const cv::FileStorage json(file, cv::FileStorage::READ | cv::FileStorage::FORMAT_JSON);
  if (!json.isOpened()) return Error{"cannot read " + file};
  const cv::FileNode camera = json["camera"];
  if (camera.empty() || camera["fx"].empty() || json["ceiling_height_m"].empty()) {
    return Error{file + ": expected camera, mount and ceiling_height_m"};
  }
  read_camera(camera, json["mount"], sequence);
  sequence.ceiling_height_m = json["ceiling_height_m"].real();
  for (int i = 0;; ++i) {
    char name[16];
    std::snprintf(name, sizeof(name), "%03d.png", i);
    const cv::Mat frame = read_grey(folder / "frames" / name);
    if (frame.empty()) break;
    if (frame.cols != sequence.robot.lens.width_px || frame.rows != sequence.robot.lens.height_px) {
      return Error{std::string(name) + ": another size than camera.json says"};
    }
    sequence.frames.push_back(frame);
  }
  if (sequence.frames.empty()) return Error{"no frames in " + (folder / "frames").string()};
  return sequence;
}

}  // namespace zenith
