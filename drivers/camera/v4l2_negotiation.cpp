#include "drivers/camera/v4l2_negotiation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "drivers/camera/luma_format.h"

namespace zenith {
namespace {

constexpr double kRateTolerance = 0.02;  // 29.97 passes for 30
constexpr double kRateWorthAWarning = 0.10;

bool reaches(double offered_hz, double wanted_hz) {
  return offered_hz >= wanted_hz * (1.0 - kRateTolerance);
}

V4l2Interval interval_of(double rate_hz) {
  constexpr double kScale = 1000.0;
  return {static_cast<std::uint32_t>(kScale),
          static_cast<std::uint32_t>(std::lround(rate_hz * kScale))};
}

struct Candidate {
  std::uint32_t fourcc = 0;
  std::size_t cost = 0;  // place in luma_formats()
  V4l2Interval interval;
};

// Unknown rates are taken to suffice: the driver is asked for the rate when the stream starts.
bool better(const Candidate& a, const Candidate& b, double wanted_hz) {
  const auto suffices = [wanted_hz](const Candidate& c) {
    return !c.interval.known() || reaches(c.interval.rate_hz(), wanted_hz);
  };
  if (suffices(a) != suffices(b)) return suffices(a);
  const bool same_rate = suffices(a) || a.interval.rate_hz() == b.interval.rate_hz();
  if (!same_rate) return a.interval.rate_hz() > b.interval.rate_hz();
  return a.cost < b.cost;
}

const V4l2SizeOffer* find_size(const V4l2FormatOffer& format, const V4l2Settings& settings) {
  for (const V4l2SizeOffer& size : format.sizes) {
    if (size.holds(settings.width, settings.height)) return &size;
  }
  return nullptr;
}

std::optional<Candidate> candidate_of(const V4l2FormatOffer& format, const V4l2Settings& settings) {
  const LumaFormat* luma = find_luma_format(format.fourcc);
  if (luma == nullptr) return std::nullopt;
  if (settings.format != "auto" && fourcc_of(settings.format) != format.fourcc) return std::nullopt;
  Candidate candidate;
  candidate.fourcc = format.fourcc;
  candidate.cost = static_cast<std::size_t>(luma - luma_formats().data());
  if (format.sizes.empty()) return candidate;  // S_FMT will tell
  const V4l2SizeOffer* size = find_size(format, settings);
  if (size == nullptr) return std::nullopt;
  candidate.interval = choose_interval(size->rates, settings.rate_hz);
  return candidate;
}

std::string asked_text(const V4l2Settings& settings) {
  return std::to_string(settings.width) + "x" + std::to_string(settings.height) + " at " +
         rate_text(settings.rate_hz) + ", format " + settings.format;
}

// The most helpful reason why no candidate is left.
std::string reason(const V4l2Offer& offer, const V4l2Settings& settings) {
  const std::string size = std::to_string(settings.width) + "x" + std::to_string(settings.height);
  const bool named = settings.format != "auto";
  bool readable = false;
  bool compressed_has_size = false;
  for (const V4l2FormatOffer& format : offer.formats) {
    if (named && fourcc_of(settings.format) != format.fourcc) continue;
    if (find_luma_format(format.fourcc) != nullptr) {
      readable = true;
    } else if (format.compressed) {
      compressed_has_size |= format.sizes.empty() || find_size(format, settings) != nullptr;
    }
  }
  if (compressed_has_size) {
    return "only compressed frames are offered at " + size +
           ", and those are not decoded: ask for a size that an uncompressed format has";
  }
  if (readable) return size + " is not offered: ask for one of the sizes below";
  if (named && find_luma_format(fourcc_of(settings.format)) == nullptr) {
    return "the format '" + settings.format + "' cannot be read: ask for \"auto\"";
  }
  if (named) return "the format '" + settings.format + "' is not offered: ask for \"auto\"";
  return "it has no grey or YUV format (Bayer sensors need the libcamera driver)";
}

Error no_mode(const V4l2Offer& offer, const V4l2Settings& settings) {
  return {offer.path + " (" + offer.card + "): asked for " + asked_text(settings) + "; " +
          reason(offer, settings) + ". The device offers: " + offer_text(offer) + "."};
}

void warn_of_rate(V4l2Mode& mode, double wanted_hz) {
  if (!mode.interval.known()) return;
  const double rate_hz = mode.interval.rate_hz();
  if (std::abs(rate_hz - wanted_hz) <= kRateWorthAWarning * wanted_hz) return;
  mode.warnings.push_back("the camera offers " + rate_text(rate_hz) + " instead of " +
                          rate_text(wanted_hz) + " at this size and format");
}

}  // namespace

V4l2Interval choose_interval(const V4l2Rates& rates, double rate_hz) {
  if (rates.is_range()) {
    if (rate_hz >= rates.shortest.rate_hz()) return rates.shortest;
    if (rate_hz <= rates.longest.rate_hz()) return rates.longest;
    return interval_of(rate_hz);
  }
  V4l2Interval best;
  for (const V4l2Interval& interval : rates.discrete) {
    if (!interval.known()) continue;
    const double offered_hz = interval.rate_hz();
    const bool suffices = reaches(offered_hz, rate_hz);
    const bool best_suffices = best.known() && reaches(best.rate_hz(), rate_hz);
    if (!best.known() || (suffices && !best_suffices) ||
        (suffices && offered_hz < best.rate_hz()) ||
        (!best_suffices && offered_hz > best.rate_hz())) {
      best = interval;
    }
  }
  return best;
}

Result<V4l2Mode> negotiate_v4l2(const V4l2Offer& offer, const V4l2Settings& settings) {
  std::optional<Candidate> best;
  for (const V4l2FormatOffer& format : offer.formats) {
    const auto candidate = candidate_of(format, settings);
    if (!candidate) continue;
    if (!best || better(*candidate, *best, settings.rate_hz)) best = candidate;
  }
  if (!best) return no_mode(offer, settings);
  V4l2Mode mode = {best->fourcc, settings.width, settings.height, best->interval, {}};
  warn_of_rate(mode, settings.rate_hz);
  return mode;
}

}  // namespace zenith
