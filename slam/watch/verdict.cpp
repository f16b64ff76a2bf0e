#include "slam/watch/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

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
     " ms late against the frames'; expected 0: stamp both when they are measured, by one "
     "clock, or correct the offset"},
    {"stamps_jitter", "the stamps of frames or wheels jitter by about ", 0,
     " ms; expected less than 5: use the capture's stamps, not those of their arrival"},
    {"lens_wrong", "the picture turns about a point ", 1,
     " degrees away from the vertical; expected 0: the lens calibration is of another "
     "resolution or crop, or the camera's roll and pitch are wrong"},
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
  std::array<char, 321> text;
  if (code.decimals < 0) {
    std::snprintf(text.data(), text.size(), "%s", code.before);
  } else {
    const double value = std::isfinite(reason.value) ? reason.value : 0.0;
    std::snprintf(text.data(), text.size(), "%s%.*f%s", code.before, code.decimals, value,
                  code.after);
  }
  return ReasonText(text.data());
}

}  // namespace zenith
