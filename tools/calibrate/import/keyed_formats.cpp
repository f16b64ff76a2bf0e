// Formats that give each number its own key. Facts: Basalt's calibration files (cereal's JSON),
// camodocal's camera models as VINS-Mono and VINS-Fusion read them, ORB-SLAM3's "Calibration
// tutorial", stella_vslam's configuration.

#include <algorithm>
#include <cmath>

#include "tools/calibrate/import/formats.h"
#include "tools/calibrate/import/lens_builder.h"

namespace zenith::tools {
namespace {

void set_pinhole_keys(LensBuilder& lens, const Node& map) {
  const double fx = lens.number(map, {"fx", "flx", "camfx", "focallengthx", "gamma1", "mu", "f"});
  const double fy = lens.number_or(map, {"fy", "fly", "camfy", "focallengthy", "gamma2", "mv"}, fx);
  const double cx = lens.number(map, {"cx", "ppx", "camcx", "principalpointx", "u0"});
  const double cy = lens.number(map, {"cy", "ppy", "camcy", "principalpointy", "v0"});
  lens.set_pinhole(fx, fy, cx, cy);
}

bool has_pinhole_keys(const Node& map) {
  return find(map, {"fx", "flx", "camfx", "focallengthx"}) != nullptr &&
         find(map, {"cx", "ppx", "camcx", "principalpointx"}) != nullptr;
}

// k1 k2 p1 p2 k3 k4 k5 k6 under their names. A format's program writes the first `required` of
// them always: one that is missing was lost. The others are zero then.
std::vector<double> radtan_keys(LensBuilder& lens, const Node& map, std::size_t required) {
  std::vector<double> d;
  for (const std::string_view key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
    d.push_back(d.size() < required ? lens.number(map, {key}) : lens.number_or(map, {key}, 0.0));
  }
  return d;
}

// Of files that anything may have written: what is taken for zero is said.
std::vector<double> any_radtan_keys(LensBuilder& lens, const Node& map) {
  std::string missing;
  for (const std::string_view key : {"k1", "k2", "p1", "p2"}) {
    if (find(map, {key}) == nullptr) missing += (missing.empty() ? "" : ", ") + std::string(key);
  }
  if (!missing.empty()) lens.note("the file has no " + missing + ": taken as zero");
  return radtan_keys(lens, map, 0);
}

std::vector<double> fisheye_keys(LensBuilder& lens, const Node& map) {
  return {lens.number(map, {"k1"}), lens.number(map, {"k2"}), lens.number(map, {"k3"}),
          lens.number(map, {"k4"})};
}

// p0, p1, ... up to the last that is there.
std::vector<double> polynomial_keys(LensBuilder& lens, const Node* map) {
  std::vector<double> values;
  if (map == nullptr) return values;
  for (int i = 0; i < 40; ++i) {
    const std::string key = "p" + std::to_string(i);
    if (find(*map, {key}) == nullptr) break;
    values.push_back(lens.number(*map, {key}));
  }
  return values;
}

// camodocal has (u, v) = [C D; E 1] rho e + centre, x along u; OCamCalib's (and Lens's) x goes
// downwards, and the 1 stands with u. With rho' = C rho the 1 moves: a'_n = a_n C^(1 - n),
// b'_n = C b_n.
void set_camodocal_scaramuzza(LensBuilder& lens, const Node& map) {
  const Node* affine = find(map, {"affineparameters"});
  if (affine == nullptr) return lens.refuse("there are no affine_parameters");
  const double C = lens.number(*affine, {"ac"});
  const double D = lens.number(*affine, {"ad"});
  const double E = lens.number(*affine, {"ae"});
  const double cx = lens.number(*affine, {"cx"});
  const double cy = lens.number(*affine, {"cy"});
  auto a = polynomial_keys(lens, find(map, {"polyparameters"}));
  auto b = polynomial_keys(lens, find(map, {"invpolyparameters"}));
  if (a.empty() || !(std::abs(C) > 0.1)) {
    return lens.refuse("expected poly_parameters p0 .. and affine_parameters with ac near 1");
  }
  for (std::size_t n = 0; n < a.size(); ++n) a[n] *= std::pow(C, 1.0 - static_cast<double>(n));
  for (double& value : b) value *= C;
  lens.set_pinhole(1.0, 1.0, cx, cy);
  lens.set_scaramuzza(1.0 / C, E / C, D / C, a, b);
}

}  // namespace

std::optional<ForeignLens> read_basalt(const Node& map, const std::string& name,
                                       ForeignModel wanted) {
  const Node* type = find(map, {"cameratype"});
  const Node* in = find(map, {"intrinsics"});
  if (type == nullptr || in == nullptr || !in->is_map()) return std::nullopt;
  LensBuilder lens("Basalt", name, wanted);
  lens.size_from(map);
  const std::string model = lower(trimmed(type->text));
  if (model == "bal") {
    lens.refuse("the camera type bal has no principal point; calibrate with another one (ds, kb4)");
    return lens.take();
  }
  set_pinhole_keys(lens, *in);
  if (model == "pinhole") {
    lens.set_distortion("none", {});
  } else if (model == "pinhole-radtan8" || model == "pinhole-radtan5" ||
             model == "pinhole-radtan") {
    lens.set_distortion("rational", radtan_keys(lens, *in, model.ends_with('8') ? 8 : 4));
  } else if (model == "kb4") {
    lens.set_distortion("kb4", fisheye_keys(lens, *in));
  } else if (model == "ds") {
    lens.set_double_sphere(lens.number(*in, {"xi"}), lens.number(*in, {"alpha"}));
  } else if (model == "eucm") {
    lens.set_eucm(lens.number(*in, {"alpha"}), lens.number(*in, {"beta"}));
  } else if (model == "ucm") {
    lens.set_eucm(lens.number(*in, {"alpha"}), 1.0);
  } else if (model == "fov") {
    lens.set_fov(lens.number(*in, {"w"}));
  } else {
    lens.refuse("the camera type '" + LensBuilder::text(map, {"cameratype"}) +
                "' is none of ds, eucm, ucm, kb4, pinhole, pinhole-radtan8 and fov");
  }
  return lens.take();
}

std::optional<ForeignLens> read_camodocal(const Node& map, const std::string& name,
                                          ForeignModel wanted) {
  const std::string type = plain_key(LensBuilder::text(map, {"modeltype"}));
  const Node* projection = find(map, {"projectionparameters"});
  if (type.empty() || (projection == nullptr && find(map, {"polyparameters"}) == nullptr)) {
    return std::nullopt;
  }
  const std::string own = LensBuilder::text(map, {"cameraname"});
  LensBuilder lens("camodocal (VINS)", own.empty() ? name : own, wanted);
  lens.size_from(map);
  const Node nothing{Node::Kind::kMap, {}, {}, {}};
  const Node* found = find(map, {"distortionparameters"});
  const Node& distortion = found == nullptr ? nothing : *found;
  if (projection != nullptr) set_pinhole_keys(lens, *projection);
  if (type == "pinhole" || type == "pinholefull") {
    lens.set_distortion(type == "pinhole" ? "radtan" : "rational",
                        radtan_keys(lens, distortion, type == "pinhole" ? 4 : 8));
  } else if (type == "kannalabrandt" && projection != nullptr) {
    lens.set_distortion("equidistant",
                        {lens.number(*projection, {"k2"}), lens.number(*projection, {"k3"}),
                         lens.number(*projection, {"k4"}), lens.number(*projection, {"k5"})});
  } else if (type == "mei") {
    const Node* mirror = find(map, {"mirrorparameters"});
    const auto d = radtan_keys(lens, distortion, 4);
    lens.set_omni(lens.number(mirror == nullptr ? nothing : *mirror, {"xi"}),
                  {d[0], d[1], d[2], d[3]});
  } else if (type == "scaramuzza") {
    set_camodocal_scaramuzza(lens, map);
  } else {
    lens.refuse("the model_type '" + LensBuilder::text(map, {"modeltype"}) +
                "' is none of PINHOLE, PINHOLE_FULL, KANNALA_BRANDT, MEI and SCARAMUZZA");
  }
  return lens.take();
}

std::optional<ForeignLens> read_plain_keys(const Node& map, const std::string& name,
                                           ForeignModel wanted) {
  if (!has_pinhole_keys(map)) return std::nullopt;
  const bool orb = name.starts_with("Camera");
  LensBuilder lens(orb ? "ORB-SLAM" : "fx, fy, cx, cy", name, wanted);
  lens.size_from(map);
  set_pinhole_keys(lens, map);
  std::string word = LensBuilder::text(map, {"distortionmodel", "distortiontype", "model", "type",
                                             "cameramodel", "cammodel", "modelname"});
  const bool any_k = find(map, {"k1", "k2", "k3", "k4", "p1", "p2"}) != nullptr;
  const Node* list = find(map, {"coeffs", "distortioncoefficients", "distortioncoeffs",
                                "distcoeffs", "distcoeff", "distortion", "dist", "d"});
  // A "w" beside an "h" is a width.
  const bool omega = find(map, {"omega", "fovw"}) != nullptr ||
                     (find(map, {"w"}) != nullptr && find(map, {"h"}) == nullptr);
  const std::string plain = plain_key(word);
  const bool fisheye_said = plain == "kannalabrandt8" || plain == "kannalabrandt4" ||
                            plain == "fisheye" || plain == "opencvfisheye" ||
                            plain == "equidistant" || plain == "kb4";
  const bool fisheye =
      wanted == ForeignModel::kFisheye || (wanted == ForeignModel::kAsTheFileSays && fisheye_said);
  const bool alpha = find(map, {"alpha"}) != nullptr;
  if (list != nullptr && !list->is_map()) {
    lens.set_distortion(word, lens.numbers(*list, list->key));
  } else if (alpha && find(map, {"xi"}) != nullptr) {
    lens.set_double_sphere(lens.number(map, {"xi"}), lens.number(map, {"alpha"}));
  } else if (alpha) {
    lens.set_eucm(lens.number(map, {"alpha"}), lens.number_or(map, {"beta"}, 1.0));
  } else if (plain == "atan" || plain == "fov" || (word.empty() && omega)) {
    lens.set_fov(lens.number(map, {"omega", "fovw", "w", "camd0"}));
  } else if (any_k && fisheye) {
    lens.set_distortion(word, fisheye_keys(lens, map));
  } else if (any_k) {
    const bool tangential = find(map, {"p1"}) != nullptr;
    if (word.empty() && !tangential && find(map, {"k4"}) != nullptr &&
        wanted == ForeignModel::kAsTheFileSays) {
      lens.refuse(
          "k1 .. k4 without p1 and p2 may be a fisheye's or a pinhole's: say which, "
          "--model fisheye or --model pinhole");
    } else {
      const std::string pinhole = plain == "pinhole" || word.empty() ? "radtan" : word;
      lens.set_distortion(pinhole, orb ? radtan_keys(lens, map, 4) : any_radtan_keys(lens, map));
    }
  } else if (find(map, {"camd0"}) != nullptr) {  // SVO of 2014
    lens.set_distortion(word,
                        {lens.number_or(map, {"camd0"}, 0.0), lens.number_or(map, {"camd1"}, 0.0),
                         lens.number_or(map, {"camd2"}, 0.0), lens.number_or(map, {"camd3"}, 0.0)});
  } else if (plain == "rectified" || plain == "none" || plain == "pinhole" ||
             plain == "perspective" || (orb && word.empty())) {
    lens.set_distortion("none", {});
    lens.note("the file has no distortion: right for rectified images only");
  } else {
    lens.refuse("there are fx, fy, cx and cy, but no distortion that is known here" +
                (word.empty() ? std::string() : " (the model is '" + word + "')") +
                ": expected k1, k2, p1, p2, or a list of coefficients");
  }
  return lens.take();
}

std::optional<ForeignLens> read_nested_keys(const Node& map, const std::string& name,
                                            ForeignModel wanted) {
  Node merged{Node::Kind::kMap, map.key, {}, {}};
  bool pinhole = false;
  for (const Node& child : map.children) {
    const std::string plain = plain_key(child.key);
    const bool intrinsics = child.is_map() && has_pinhole_keys(child);
    const bool distortion = child.is_map() && plain.starts_with("dist");
    if (intrinsics && pinhole) return std::nullopt;  // several cameras
    pinhole = pinhole || intrinsics;
    if (intrinsics || distortion) {
      merged.children.insert(merged.children.end(), child.children.begin(), child.children.end());
    } else {
      merged.children.push_back(child);
    }
  }
  const bool beside = merged.children.size() > 0 && pinhole &&
                      std::any_of(map.children.begin(), map.children.end(), [](const Node& child) {
                        return plain_key(child.key).starts_with("dist");
                      });
  if (!beside) return std::nullopt;
  return read_plain_keys(merged, name, wanted);
}

}  // namespace zenith::tools
