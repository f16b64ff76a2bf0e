#include "slam/watch/verdict.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace zenith {
namespace {

// A line: `before`, Reason::value with so many decimals, `after`. Without a number: decimals -1.
struct CodeInfo {
  std::string_view name;
  const char* before;
  int decimals;
  const char* after;
};

constexpr std::array<CodeInfo, kSetupCodes> kCodes = {{
    {"not_judged_yet",
     "the robot has not driven and turned enough with something to see for camera and wheels "
     "to be compared; drive 2 m and turn by 90 degrees",
     -1, ""},
    {"picture_mirrored",
     "the picture turns against the wheels and moves the wrong way, as in a mirror; expected "
     "an unmirrored picture: switch off the camera's horizontal or vertical flip (or flip "
     "only one of them back)",
     -1, ""},
    {"yaw_wrong", "driving straight looks like driving ", 1,
     " degrees to the left of straight ahead; expected 0: take as much from the camera's yaw "
     "(mount, T_BS), or calibrate the drive again"},
    {"wheels_swapped",
     "the picture turns against the wheels but moves the right way; expected the same sense: "
     "exchange left and right wheel (or the picture is mirrored across the direction of "
     "driving)",
     -1, ""},
    {"left_wheel_reversed",
     "turning looks like driving straight; expected left and right to count forward: reverse "
     "the sign of the left wheel",
     -1, ""},
    {"right_wheel_reversed",
     "turning looks like driving straight; expected left and right to count forward: reverse "
     "the sign of the right wheel",
     -1, ""},
    {"wheels_reversed",
     "the wheels tell of driving backward and of turning the other way than is seen; expected "
     "forward: reverse the signs of both wheels",
     -1, ""},
    {"wheels_contradict", "the wheels do not explain ", 0,
     " % of the turning that is seen; expected less than 10 %: check which CAN signals are "
     "the wheels', track width, and the clocks of camera and wheels"},
    {"turn_scale", "the wheels tell of ", 3,
     " times the turning that is seen; expected 1: the travel per count of both wheels (then "
     "all distances are off by it, too) or the track width is wrong"},
    {"wheels_unequal", "driving straight by the wheels turns the robot by ", 1,
     " degrees a metre; expected 0: the scales of left and right wheel differ; calibrate the "
     "drive again"},
    {"stamps_apart", "the wheels' stamps are ", 0,
     " ms late (less than 0: early) against the frames'; expected 0: stamp both when they are measured, by one "
     "clock, or correct the offset"},
    {"stamps_jitter", "the stamps of frames or wheels jitter by about ", 0,
     " ms; expected less than 5: use the capture's stamps, not those of their arrival"},
    {"lens_wrong", "the picture turns or converges about a point ", 1,
     " degrees away from the vertical; expected 0: the lens calibration is of another "
     "resolution or crop, or the camera's roll and pitch are wrong"},
    {"focal_wrong",
     "corners beside the line of driving swerve as with another focal length; expected straight "
     "lines: the lens calibration is of another lens, zoom or resolution; calibrate the lens",
     -1, ""},
    {"picture_frozen",
     "the wheels turn but the camera delivers one and the same picture; expected new ones: "
     "restart the camera or its driver",
     -1, ""},
    {"frames_repeated", "", 0,
     " % of the frames repeat the last picture while the robot drives; expected none: take "
     "each picture once, at the camera's own rate"},
    {"frames_missing", "no frame came for ", 1,
     " s while the robot drove; expected one every period: check camera, cable and load; the "
     "map was continued by the wheels alone"},
    {"lens_covered", "the picture was dark over ", 1,
     " m of driving; expected a lit ceiling: uncover the lens, or check exposure and light"},
    {"nothing_to_see", "no corner was seen over ", 1,
     " m of driving; expected some: focus, lower corner_min_eigenvalue, or drive where the "
     "ceiling has structure; the pose is the wheels'"},
    {"robot_in_view", "", 0,
     " % of the corners stand still while the picture moves; expected none: something of the "
     "robot, or dirt on the lens, is in view"},
    {"wheels_slipped", "the wheels told of motion that the camera did not see (", 0,
     " cm or degrees); expected them to agree: the map may be bent from there on"},
    {"robot_pushed", "the camera saw motion that the wheels did not tell of (", 0,
     " cm or degrees): pushed or turned by hand; the map may be bent from there on"},
    {"view_jumped", "the view changed at once to one that has nothing in common with the last (", 0,
     " comparisons): lifted and put down elsewhere; the map may be wrong from there on"},
    {"lost", "the ceiling does not fit the map (", 1,
     " s); the robot does not know where it is: drive to a mapped place, or start a new map"},
}};

// With so many decimals; values beyond 1e9 stop there.
std::string_view decimal(double value, int decimals, std::array<char, 32>& out) {
  std::int64_t unit = 1;
  for (int i = 0; i < decimals; ++i) unit *= 10;
  const std::int64_t scaled =
      std::llround(std::min(std::abs(value), 1e9) * static_cast<double>(unit));
  char* at = out.data();
  if (value < 0.0 && scaled != 0) *at++ = '-';
  at = std::to_chars(at, out.data() + out.size(), scaled / unit).ptr;
  if (decimals > 0) *at++ = '.';
  for (std::int64_t place = unit / 10; place > 0; place /= 10) {
    *at++ = static_cast<char>('0' + scaled / place % 10);
  }
  return {out.data(), static_cast<std::size_t>(at - out.data())};
}

}  // namespace

std::string_view verdict_name(VerdictState state) {
  constexpr std::array<std::string_view, 3> kNames = {"good", "doubtful", "wrong"};
  return kNames[static_cast<std::size_t>(state)];
}

std::string_view setup_code_name(SetupCode code) {
  return kCodes[static_cast<std::size_t>(code)].name;
}

bool gives(const SetupVerdict& verdict, SetupCode code) {
  return std::any_of(verdict.reasons.begin(), verdict.reasons.end(),
                     [code](const Reason& reason) { return reason.code == code; });
}

ReasonText reason_text(const Reason& reason) {
  const CodeInfo& code = kCodes[static_cast<std::size_t>(reason.code)];
  std::array<char, 320> text;
  std::size_t length = 0;
  const auto add = [&](std::string_view part) {
    const std::size_t fits = std::min(part.size(), text.size() - length);
    std::copy_n(part.begin(), fits, text.begin() + static_cast<std::ptrdiff_t>(length));
    length += fits;
  };
  add(code.before);
  if (code.decimals >= 0) {
    std::array<char, 32> number;
    add(decimal(std::isfinite(reason.value) ? reason.value : 0.0, code.decimals, number));
    add(code.after);
  }
  return ReasonText({text.data(), length});
}

}  // namespace zenith
