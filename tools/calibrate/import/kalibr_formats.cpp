// Kalibr, and what lists its numbers as Kalibr does: model, intrinsics, distortion, size.
// Facts: Kalibr's wiki, "Yaml formats" and "Supported models"; SVO's and maplab's camera files;
// OKVIS's configuration.

#include "tools/calibrate/import/formats.h"
#include "tools/calibrate/import/lens_builder.h"

namespace zenith::tools {

ForeignLens kalibr_lens(const Node& map, const std::string& name, const std::string& format,
                        const std::string& camera_model, const std::string& distortion,
                        const Node& intrinsics, const Node* coefficients, ForeignModel wanted) {
  LensBuilder lens(format, name, wanted);
  lens.size_from(map);
  // "pinhole-radtan" stands for both.
  const std::string model = lower(camera_model.substr(0, camera_model.find('-')));
  const std::string behind =
      camera_model.find('-') == camera_model.npos ? "" : camera_model.substr(model.size() + 1);
  const std::string word = distortion.empty() ? behind : distortion;
  const bool none = plain_key(word) == "none";
  const auto in = lens.numbers(intrinsics, "intrinsics");
  const auto d =
      coefficients == nullptr ? std::vector<double>() : lens.numbers(*coefficients, "distortion");
  const std::size_t expected = model == "omni" || model == "unifiedprojection" ? 5
                               : model == "ds" || model == "eucm"              ? 6
                                                                               : 4;
  const bool known = expected > 4 || model == "pinhole" || model.empty();
  if (!known) {
    lens.refuse("the camera model '" + camera_model +
                "' is none of pinhole, omni, ds and eucm; calibrate with `zenith calibrate lens`");
  } else if (in.size() != expected) {
    lens.refuse("the model " + (model.empty() ? "pinhole" : model) + " has " +
                std::to_string(expected) + " intrinsics, found " + std::to_string(in.size()));
  }
  if (lens.refused()) return lens.take();
  const std::size_t f = expected - 4;
  lens.set_pinhole(in[f], in[f + 1], in[f + 2], in[f + 3]);
  if (expected == 4) {
    if (word.empty() && d.empty()) {
      lens.refuse("there is no distortion: expected distortion_model and distortion_coeffs");
    } else {
      lens.set_distortion(word, d);
    }
  } else if (expected == 5) {
    const std::string plain = plain_key(word);
    if (none || plain == "radtan" || plain == "radialtangential") {
      lens.set_omni(in[0], none ? std::vector<double>(4, 0.0) : d);
    } else {
      lens.refuse("the model omni with the distortion '" + word +
                  "' is none that a lens here has: expected radtan or none; calibrate with "
                  "omni-radtan or `zenith calibrate lens`");
    }
  } else if (!none && !word.empty()) {
    lens.refuse("the model " + model + " has no distortion '" + word + "': expected none");
  } else if (model == "ds") {
    lens.set_double_sphere(in[0], in[1]);
  } else {
    lens.set_eucm(in[0], in[1]);
  }
  return lens.take();
}

namespace {

// Our own sensor.yaml alone has this in Kalibr's words: c, d, e, 1, 1, cu, cv, and the polynomials.
ForeignLens scaramuzza_lens(const Node& map, const std::string& name, const Node& intrinsics,
                            ForeignModel wanted) {
  LensBuilder lens("sensor.yaml", name, wanted);
  lens.size_from(map);
  const auto in = lens.numbers(intrinsics, "intrinsics");
  const auto list = [&](std::string_view key) {
    const Node* node = find(map, {key});
    return node == nullptr ? std::vector<double>() : lens.numbers(*node, node->key);
  };
  if (in.size() != 7) {
    lens.refuse("the model scaramuzza has 7 intrinsics, found " + std::to_string(in.size()));
    return lens.take();
  }
  lens.set_pinhole(1.0, 1.0, in[5], in[6]);
  lens.set_scaramuzza(in[0], in[1], in[2], list("polynomial"), list("inversepolynomial"));
  return lens.take();
}

}  // namespace

std::optional<ForeignLens> read_kalibr(const Node& map, const std::string& name,
                                       ForeignModel wanted) {
  const Node* intrinsics = find(map, {"intrinsics"});
  if (intrinsics == nullptr || intrinsics->is_map()) return std::nullopt;
  const auto values = numbers_of(*intrinsics);
  if (values && (values->size() == 9 || values->size() == 12)) return std::nullopt;  // a matrix
  if (!values && intrinsics->is_list() && !intrinsics->children.empty() &&
      intrinsics->children.front().is_map()) {
    return std::nullopt;  // Basalt's
  }
  const std::string model = LensBuilder::text(map, {"cameramodel"});
  if (model == "scaramuzza") return scaramuzza_lens(map, name, *intrinsics, wanted);
  const Node* coefficients =
      find(map, {"distortioncoeffs", "distortioncoefficients", "distortion"});
  const std::string distortion = LensBuilder::text(map, {"distortionmodel", "distortiontype"});
  if (model.empty() && distortion.empty() && coefficients == nullptr) return std::nullopt;
  return kalibr_lens(map, name, "Kalibr", model, distortion, *intrinsics, coefficients, wanted);
}

std::optional<ForeignLens> read_svo(const Node& map, const std::string& name, ForeignModel wanted) {
  const Node* intrinsics = find(map, {"intrinsics"});
  const std::string type = LensBuilder::text(map, {"type"});
  if (intrinsics == nullptr || !intrinsics->is_map() || type.empty() ||
      find(*intrinsics, {"data"}) == nullptr) {
    return std::nullopt;
  }
  const Node* distortion = find(map, {"distortion"});
  const Node* coefficients =
      distortion == nullptr ? nullptr : find(*distortion, {"parameters", "data"});
  const std::string word =
      distortion == nullptr ? "none" : LensBuilder::text(*distortion, {"type"});
  const std::string label = LensBuilder::text(map, {"label", "id"});
  const std::string model = plain_key(type) == "unifiedprojection" ? "unifiedprojection" : type;
  return kalibr_lens(map, label.empty() ? name : label, "SVO", model, word, *intrinsics,
                     coefficients, wanted);
}

std::optional<ForeignLens> read_okvis(const Node& map, const std::string& name,
                                      ForeignModel wanted) {
  const Node* focal = find(map, {"focallength"});
  const Node* centre = find(map, {"principalpoint"});
  if (focal == nullptr || centre == nullptr) return std::nullopt;
  LensBuilder lens("OKVIS", name, wanted);
  lens.size_from(map);
  const auto f = lens.numbers(*focal, focal->key);
  const auto c = lens.numbers(*centre, centre->key);
  if (f.empty() || f.size() > 2 || c.size() != 2) {
    lens.refuse("expected two focal lengths and two coordinates of the principal point");
    return lens.take();
  }
  lens.set_pinhole(f[0], f.back(), c[0], c[1]);
  const Node* coefficients = find(map, {"distortioncoefficients", "distortioncoeffs"});
  if (coefficients == nullptr) {
    lens.refuse("there are no distortion_coefficients");
    return lens.take();
  }
  lens.set_distortion(LensBuilder::text(map, {"distortiontype", "distortionmodel"}),
                      lens.numbers(*coefficients, coefficients->key));
  return lens.take();
}

}  // namespace zenith::tools
