#include "tools/report/confidence_picture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tools/report/canvas.h"
#include "tools/report/table.h"

namespace zenith::tools {
namespace {

constexpr int kWidth_px = 1600;
constexpr int kHeight_px = 860;
constexpr double kLeft_px = 110.0;
constexpr double kRight_px = kWidth_px - 60.0;
constexpr double kTop_px = 260.0;
constexpr double kBottom_px = kHeight_px - 90.0;

struct Curve {
  std::string name;
  Colour colour;
  std::vector<double> confidence;   // by frame
  std::vector<std::size_t> merged;  // frames at which the maps were merged
  std::vector<std::size_t> withdrawn;
};

Curve make_curve(const TeamLog& log, std::size_t own, std::size_t peer, std::size_t index) {
  Curve curve;
  curve.name = log.robots[own].name + " about " + log.robots[peer].name;
  curve.colour = robot_colour(index);
  bool merged = false;
  for (std::size_t i = 0; i < log.robots[own].frames.size(); ++i) {
    const PeerLog* view = find_peer(log.robots[own].frames[i], static_cast<int>(peer));
    curve.confidence.push_back(view == nullptr ? 0.0 : std::clamp(view->confidence, 0.0, 1.0));
    const bool now = view != nullptr && view->state == AlignmentState::kMerged;
    if (now && !merged) curve.merged.push_back(i);
    if (!now && merged) curve.withdrawn.push_back(i);
    merged = now;
  }
  return curve;
}

std::vector<Curve> make_curves(const TeamLog& log) {
  std::vector<Curve> curves;
  const std::size_t size = log.robots.size();
  for (std::size_t own = 0; own < size; ++own) {
    for (std::size_t peer = 0; peer < size; ++peer) {
      if (own != peer)
        curves.push_back(make_curve(log, own, peer, size == 2 ? own : curves.size()));
    }
  }
  return curves;
}

Eigen::Vector2d at(double frame, double last_frame, double confidence) {
  return {kLeft_px + (kRight_px - kLeft_px) * frame / std::max(1.0, last_frame),
          kBottom_px - (kBottom_px - kTop_px) * confidence};
}

void draw_axes(Canvas& canvas, double last_frame) {
  for (int tenth = 0; tenth <= 10; tenth += 2) {
    const double y = at(0.0, 1.0, tenth / 10.0).y();
    canvas.line({kLeft_px, y}, {kRight_px, y}, kPale, 1.0);
    canvas.text({kLeft_px - 14.0, y + 6.0}, fixed(tenth / 10.0, 1), 13.0, kInk, Anchor::kRight);
  }
  double step = 10.0;
  for (int i = 0; last_frame / step > 12.0; ++i) step *= i % 3 == 1 ? 2.5 : 2.0;
  for (double frame = 0.0; frame <= last_frame; frame += step) {
    const double x = at(frame, last_frame, 0.0).x();
    canvas.line({x, kBottom_px}, {x, kBottom_px + 7.0}, kInk, 1.2);
    canvas.text({x, kBottom_px + 28.0}, fixed(frame, 0), 13.0, kInk, Anchor::kCentre);
  }
  canvas.line({kLeft_px, kBottom_px}, {kRight_px, kBottom_px}, kInk, 1.2);
  canvas.line({kLeft_px, kTop_px}, {kLeft_px, kBottom_px}, kInk, 1.2);
  canvas.text({0.5 * (kLeft_px + kRight_px), kHeight_px - 26.0}, "frame", 14.0, kInk,
              Anchor::kCentre);
  canvas.vertical_text({46.0, 0.5 * (kTop_px + kBottom_px) + 50.0}, "confidence", 14.0, kInk);
}

// First all lines, then all labels: no line crosses a label.
void draw_events(Canvas& canvas, const Curve& curve, double last_frame, bool labels,
                 double& label_y) {
  const auto mark = [&](std::size_t frame, const std::string& what) {
    if (label_y < kTop_px - 120.0) return;  // no room is left
    const double x = at(static_cast<double>(frame), last_frame, 0.0).x();
    const std::string text = what + ", frame " + std::to_string(frame);
    const bool beyond = x + 10.0 + canvas.text_width(text, 13.0) > kRight_px;
    const Anchor anchor = beyond ? Anchor::kRight : Anchor::kLeft;
    const Eigen::Vector2d place(x + (beyond ? -8.0 : 8.0), label_y);
    if (labels) {
      canvas.halo(place, text, 13.0, anchor);
      canvas.text(place, text, 13.0, curve.colour, anchor);
    } else {
      canvas.dashed({x, label_y - 14.0}, {x, kBottom_px}, curve.colour, 1.4);
    }
    label_y -= 20.0;
  };
  constexpr std::size_t kShown = 2;  // more would hide the curve
  for (std::size_t i = 0; i < std::min(kShown, curve.merged.size()); ++i) {
    mark(curve.merged[i], "merged");
  }
  for (std::size_t i = 0; i < std::min(kShown, curve.withdrawn.size()); ++i) {
    mark(curve.withdrawn[i], "withdrawn");
  }
}

void draw_curve(Canvas& canvas, const Curve& curve, double last_frame) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < curve.confidence.size(); ++i) {
    points.push_back(at(static_cast<double>(i), last_frame, curve.confidence[i]));
  }
  canvas.path(points, curve.colour, 2.2);
  for (const std::size_t frame : curve.merged) {
    const Eigen::Vector2d point =
        at(static_cast<double>(frame), last_frame, curve.confidence[frame]);
    canvas.disc(point, 7.0, {255, 255, 255});
    canvas.ring(point, 7.0, curve.colour, 2.5);
  }
}

void draw_threshold(Canvas& canvas, double threshold) {
  const double y = at(0.0, 1.0, threshold).y();
  canvas.dashed({kLeft_px, y}, {kRight_px, y}, kMagenta, 1.6);
}

void draw_legend(Canvas& canvas, const std::vector<Curve>& curves, double threshold) {
  double x = kLeft_px;
  double y = 102.0;
  const auto entry = [&](const std::string& name, Colour colour, bool dashed) {
    const double width = 52.0 + canvas.text_width(name, 13.0) + 36.0;
    if (x + width > kRight_px) {
      x = kLeft_px;
      y += 22.0;
    }
    if (dashed) {
      canvas.dashed({x, y - 5.0}, {x + 40.0, y - 5.0}, colour, 1.6);
    } else {
      canvas.line({x, y - 5.0}, {x + 40.0, y - 5.0}, colour, 3.0);
    }
    canvas.text({x + 52.0, y}, name, 13.0, kInk);
    x += width;
  };
  for (const Curve& curve : curves) entry(curve.name, curve.colour, false);
  entry("threshold " + fixed(threshold, 2), kMagenta, true);
}

}  // namespace

Status draw_confidence(const std::filesystem::path& path, const TeamLog& log, double threshold) {
  const std::vector<Curve> curves = make_curves(log);
  double last_frame = 1.0;
  for (const Curve& curve : curves) {
    last_frame = std::max(last_frame, static_cast<double>(curve.confidence.size()) - 1.0);
  }
  Canvas canvas(kWidth_px, kHeight_px);
  canvas.text({kLeft_px, 58.0}, "Confidence that two maps overlap", 24.0, kInk, Anchor::kLeft,
              true);
  draw_legend(canvas, curves, threshold);
  draw_axes(canvas, last_frame);
  // Events stand in rows above the curves, from the lowest row upwards.
  for (const Curve& curve : curves) draw_curve(canvas, curve, last_frame);
  for (const bool labels : {false, true}) {
    double label_y = kTop_px - 10.0;
    for (const Curve& curve : curves) draw_events(canvas, curve, last_frame, labels, label_y);
  }
  draw_threshold(canvas, threshold);
  return canvas.save(path);
}

}  // namespace zenith::tools
