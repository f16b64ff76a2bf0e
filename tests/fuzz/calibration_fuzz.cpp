// Any text as a lens that another program calibrated: YAML, JSON, XML and plain text. What is taken
// is a lens that the configuration takes.

#include <cmath>
#include <cstdint>
#include <string>

#include "platform/config/lens_settings.h"
#include "tests/fuzz/require.h"
#include "tools/calibrate/import/foreign_lens.h"
#include "tools/calibrate/import/native_lens.h"

namespace {

using namespace zenith;         // NOLINT(google-build-using-namespace)
using namespace zenith::tools;  // NOLINT(google-build-using-namespace)

void take(const ForeignLens& foreign, const SizeWish& wish) {
  const auto lens = native_lens(foreign, wish);
  if (!lens) {
    require(!lens.error().message.empty());
    return;
  }
  require(foreign.refused.empty());
  require(check_lens(lens->lens).ok());
  const AngleOfView angles = angle_of_view(lens->lens);
  for (const auto& angle_deg : {angles.horizontal_deg, angles.vertical_deg, angles.diagonal_deg}) {
    require(!angle_deg || (*angle_deg >= 0.0 && *angle_deg <= 360.0));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  for (const ForeignModel model : {ForeignModel::kAsTheFileSays, ForeignModel::kFisheye}) {
    const auto lenses = parse_foreign_lenses(text, "lens", model);
    if (!lenses) {
      require(lenses.error().message.starts_with("lens: "));
      require(lenses.error().message.size() < 2000);
      continue;
    }
    require(!lenses->empty() && lenses->size() <= 1000);
    // A projection takes a millisecond to make.
    for (std::size_t i = 0; i < lenses->size() && i < 3; ++i) {
      take((*lenses)[i], {});
      take((*lenses)[i], {{{640, 480}}, 0.5});
    }
  }
  return 0;
}
