#pragma once
// The lens in files and messages: its models' names, their numbers' names, ranges and order, and
// the one check of whether a lens can be. Configuration, sensor.yaml, the tap's wire, the world
// files of the simulator and `zenith calibrate` all read, write and refuse by this table.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/base/result.h"
#include "platform/config/setting.h"
#include "slam/image/lens.h"

namespace zenith {

// "equidistant", "radtan", "rational", "fov", "double_sphere", "eucm", "omni", "scaramuzza".
std::string_view lens_model_name(LensModel model);
std::optional<LensModel> find_lens_model(std::string_view name);
std::vector<std::string> lens_model_names();

// A number of a model, besides size, focal length and centre.
struct LensNumber {
  std::string_view key;  // "k1"
  double min;
  double max;
  std::string_view text;
  double& (*at)(Lens&);

  double of(const Lens& lens) const { return at(const_cast<Lens&>(lens)); }
};

// In the order in which calibrations write them: k1 k2 p1 p2 k3.
std::vector<LensNumber> lens_numbers(LensModel model);

// All keys of [lens].
Settings lens_settings(Lens& lens);
// Whether the model has such a key: "k1", "cu_px"; sizes, focal lengths and centre have all.
bool lens_model_has(LensModel model, std::string_view key);

struct LensProblem {
  std::string key;   // as in lens_settings(), without its section
  std::string what;  // " is -150, expected 1 .. 100000"
};

// Everything that is wrong with it: numbers that are none or out of range, numbers of other models,
// a centre outside of the image, a curve that shows next to nothing of the world.
std::vector<LensProblem> lens_problems(const Lens& lens);
// The same as one text, a line each: "fu_px is -150, expected 1 .. 100000".
Status check_lens(const Lens& lens);

// What a good lens's owner should know: that its curve folds back inside of the image, and up to
// which angle the image is used. Empty when there is nothing to say: a fold outside of the image,
// or one beyond 90 degrees from the axis, where image circles end, takes nothing away.
std::string lens_note(const Lens& lens);

// "equidistant, 640 x 480 px, fu 150 fv 150 cu 320 cv 240, k1 -0.012 ..", numbers in full.
std::string lens_text(const Lens& lens);

}  // namespace zenith
