#include "tools/doctor/check_camera.h"

#include <linux/v4l2-controls.h>

#include <algorithm>
#include <cmath>

#include "drivers/camera/luma_format.h"
#include "drivers/camera/v4l2_controls.h"
#include "drivers/camera/v4l2_device.h"
#include "drivers/camera/v4l2_enumerate.h"
#include "drivers/camera/v4l2_negotiation.h"
#include "platform/linux/clock.h"
#include "tools/doctor/formatted.h"

namespace zenith::tools {
namespace {

bool has(const std::vector<V4l2Control>& controls, std::uint32_t id) {
  return std::any_of(controls.begin(), controls.end(),
                     [id](const V4l2Control& control) { return control.id == id; });
}

Finding check_mode(const V4l2Offer& offer, const V4l2Settings& settings, bool& good) {
  const std::string what = "camera format";
  const auto mode = negotiate_v4l2(offer, settings);
  good = mode.ok();
  if (!mode) {
    return fail(what, mode.error().message,
                "set [lens] width_px and height_px to a size that it offers, and calibrate for it",
                "v4l2-ctl -d " + offer.path + " --list-formats-ext");
  }
  std::string found = fourcc_text(mode->fourcc) + " " + std::to_string(mode->width) + "x" +
                      std::to_string(mode->height);
  if (mode->interval.known()) found += " at " + rate_text(mode->interval.rate_hz());
  if (mode->warnings.empty()) return ok(what, found);
  for (const std::string& warning : mode->warnings) found += ": " + warning;
  return warn(what, found, "set camera.rate_hz to what it offers, or take another format");
}

Finding check_exposure(const std::vector<V4l2Control>& controls, const V4l2Settings& settings) {
  const std::string what = "camera exposure";
  const bool there = has(controls, V4L2_CID_EXPOSURE_ABSOLUTE) || has(controls, V4L2_CID_EXPOSURE);
  if (there) return ok(what, "can be set");
  if (settings.exposure == V4l2Exposure::kLeave)
    return ok(what, "cannot be set, and is left alone");
  return warn(what, "the camera has no exposure control",
              "camera.exposure asks for one: set it to \"leave\"");
}

Finding check_power_line(const std::vector<V4l2Control>& controls, const V4l2Settings& settings) {
  const std::string what = "camera flicker";
  const bool there = has(controls, V4L2_CID_POWER_LINE_FREQUENCY);
  if (there && settings.power_line != V4l2PowerLine::kLeave)
    return ok(what, "power line filter set");
  if (there) {
    return ok(what, "the camera has a filter; camera.power_line = \"50Hz\" or \"60Hz\" sets it");
  }
  if (settings.power_line == V4l2PowerLine::kLeave)
    return ok(what, "no filter, and none asked for");
  return warn(what, "the camera has no power line filter",
              "set camera.power_line to \"leave\"; an exposure of 10 ms (50 Hz) or 8.3 ms (60 Hz) "
              "avoids flicker as well");
}

}  // namespace

Findings check_camera_device(const V4l2Settings& settings, V4l2Io& io, std::string& path) {
  path.clear();
  const auto found = find_v4l2_device(io, settings.device);
  if (!found) {
    return {fail("camera device", found.error().message, "plug it in, or correct camera.device",
                 "v4l2-ctl --list-devices")};
  }
  const auto device = open_v4l2_device(io, *found);
  if (!device) {
    return {fail("camera device", device.error().message, "",
                 "sudo usermod -aG video $USER    # then log in again")};
  }
  const auto offer = enumerate_v4l2(*device, *found, settings.width, settings.height);
  if (!offer) return {fail("camera device", offer.error().message, "correct camera.device")};
  const std::string name = offer->path + " '" + offer->card + "' (" + offer->driver + ")";
  if (!offer->captures) {
    return {
        fail("camera device",
             name + " does not capture" + (offer->has_output ? ", frames are written into it" : ""),
             "name another node of it; a loop-back device captures while somebody writes",
             "v4l2-ctl --list-devices")};
  }
  if (!offer->streams) {
    return {fail("camera device", name + " does not stream by memory mapping",
                 "this driver cannot be used")};
  }
  Findings findings = {ok("camera device", name)};
  bool good = false;
  findings.push_back(check_mode(*offer, settings, good));
  if (good) path = *found;
  const auto controls = list_v4l2_controls(*device);
  findings.push_back(check_exposure(controls, settings));
  findings.push_back(check_power_line(controls, settings));
  return findings;
}

Finding check_camera_free(const std::vector<DeviceUser>& users, int daemon_pid) {
  const std::string what = "camera in use";
  std::string others;
  bool daemon = false;
  for (const DeviceUser& user : users) {
    daemon = daemon || (daemon_pid != 0 && user.pid == daemon_pid);
    // pipewire and its like look at each camera, without streaming.
    if (user.pid == daemon_pid && daemon_pid != 0) continue;
    others += (others.empty() ? "" : ", ") + user.name + " (pid " + std::to_string(user.pid) + ")";
  }
  if (others.empty()) return ok(what, daemon ? "by zenithd" : "by nobody");
  return warn(what, "open in " + others,
              "a camera streams to one program alone: end it if the daemon finds the camera busy");
}

PictureFacts measure_picture(ImageView image) {
  PictureFacts facts;
  double sum = 0.0;
  double squares = 0.0;
  double near = 0.0;  // differences of pixels one apart ...
  double far = 0.0;   // ... and four apart: noise has both alike, a picture has more of the latter
  double bright = 0.0;
  double pairs = 0.0;
  for (int v = 0; v < image.height; ++v) {
    const std::uint8_t* row = image.row(v);
    for (int u = 0; u < image.width; ++u) {
      sum += row[u];
      squares += static_cast<double>(row[u]) * row[u];
      bright += row[u] >= 250;
      if (u + 4 >= image.width) continue;
      near += std::abs(row[u] - row[u + 1]);
      far += std::abs(row[u] - row[u + 4]);
      ++pairs;
    }
  }
  const double count = std::max(1.0, static_cast<double>(image.width) * image.height);
  facts.mean = sum / count;
  facts.deviation = std::sqrt(std::max(0.0, squares / count - facts.mean * facts.mean));
  facts.bright = bright / count;
  facts.detail = pairs > 0.0 ? (far - near) / pairs : 0.0;
  return facts;
}

StreamFacts watch_camera(Camera& camera, Duration how_long, std::optional<PictureFacts>& picture) {
  StreamFacts facts;
  if (const Status opened = camera.open(); !opened) {
    facts.problem = opened.error().message;
    return facts;
  }
  // The first frame may take longer: a sensor starts.
  constexpr Duration kFirst = {5'000'000'000};
  Time limit = monotonic_now() + kFirst;
  CameraFrame frame;
  while (monotonic_now() < limit) {
    const CameraWait result = camera.wait({20'000'000}, frame);
    if (result == CameraWait::kLost) {
      facts.problem = camera.lost_reason();
      break;
    }
    if (result != CameraWait::kFrame) continue;
    facts.last_received = monotonic_now();
    if (facts.stamps.empty()) limit = facts.last_received + how_long;
    facts.stamps.push_back(frame.stamp);
    if (monotonic_now() + Duration{200'000'000} >= limit) picture = measure_picture(frame.luma);
  }
  facts.counters = camera.counters();
  camera.close();
  return facts;
}

Finding check_camera_rate(const StreamFacts& facts, double wanted_hz) {
  const std::string what = "camera rate";
  const std::size_t count = facts.stamps.size();
  if (count == 0) {
    return fail(what, facts.problem.empty() ? "no frame came" : facts.problem,
                "look at its cable, its supply and the kernel's log", "sudo dmesg | tail -30");
  }
  if (count < 3) {
    return fail(what, std::to_string(count) + " frames, then none",
                "look at its cable, its supply and the kernel's log", "sudo dmesg | tail -30");
  }
  const double seconds = (facts.stamps.back() - facts.stamps.front()).seconds();
  const double rate = seconds > 0.0 ? static_cast<double>(count - 1) / seconds : 0.0;
  std::string found = formatted("%.1f frames a second, %.4g wanted", rate, wanted_hz);
  const CameraCounters& c = facts.counters;
  if (c.damaged > 0) found += ", " + std::to_string(c.damaged) + " damaged";
  if (c.lost_in_driver > 0)
    found += ", " + std::to_string(c.lost_in_driver) + " lost in the driver";
  if (rate < 0.5 * wanted_hz) {
    return fail(what, found,
                "in the dark a long exposure slows a camera down: set camera.exposure to "
                "\"manual\", or camera.rate_hz to what it delivers");
  }
  if (rate < 0.9 * wanted_hz) {
    return warn(what, found, "a long exposure slows a camera down: see camera.exposure");
  }
  if (c.damaged + c.lost_in_driver > 0) {
    return warn(what, found, "a USB 2 port of its own and a short cable help");
  }
  return ok(what, found);
}

Finding check_camera_stamps(const StreamFacts& facts) {
  const std::string what = "camera stamps";
  if (facts.stamps.size() < 3) return skip(what, "too few frames");
  for (std::size_t i = 1; i < facts.stamps.size(); ++i) {
    if (facts.stamps[i] > facts.stamps[i - 1]) continue;
    return fail(what, "they do not rise", "the camera's driver is broken: use another kernel");
  }
  const double age_s = (facts.last_received - facts.stamps.back()).seconds();
  if (facts.counters.stamps_replaced > 0) {
    return warn(what,
                std::to_string(facts.counters.stamps_replaced) +
                    " were not of the monotonic clock and became the moment of arrival",
                "frames and wheels then fit less exactly; loop-back devices are such");
  }
  if (age_s < -0.001 || age_s > 0.5) {
    return warn(what, formatted("the last frame was %.3f s old when it came", age_s),
                "a driver that holds frames back makes poses late");
  }
  return ok(what, formatted("rise; a frame is %.0f ms old when it comes", age_s * 1e3));
}

Finding check_picture(const PictureFacts& picture) {
  const std::string what = "camera picture";
  const std::string found =
      formatted("mean %.0f, deviation %.1f", picture.mean, picture.deviation) +
      formatted(", detail %.1f", picture.detail);
  if (picture.mean < 8.0 && picture.deviation < 6.0) {
    return fail(what, "black (" + found + ")",
                "take the cap off, light the room, or set camera.exposure_us and camera.gain");
  }
  if (picture.mean > 247.0 || picture.bright > 0.6) {
    return fail(what, "white (" + found + ")",
                "shorten the exposure: camera.exposure = \"manual\" and camera.exposure_us");
  }
  if (picture.deviation < 3.0) {
    return fail(what, "one grey without anything in it (" + found + ")",
                "take the cap off; look at the picture", "v4l2-ctl --list-ctrls");
  }
  if (picture.detail < 0.6) {
    return warn(what, "hardly any detail (" + found + ")",
                "focus the lens, wipe it, or drive where the ceiling has more to see");
  }
  if (picture.bright > 0.25) {
    return warn(what, formatted("%.0f %% of it is white", 100.0 * picture.bright),
                "shorten the exposure: corners beside lamps get lost");
  }
  return ok(what, found);
}

}  // namespace zenith::tools
