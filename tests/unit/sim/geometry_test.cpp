// Where things appear in the image: against projection and against brute force.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "platform/base/random.h"
#include "sim/camera.h"
#include "sim/light.h"
#include "sim/simulation.h"
#include "sim/skyline.h"
#include "sim/world.h"
#include "slam/image/lens_projection.h"
#include "tests/unit/sim/test_world.h"

namespace zenith::sim {
namespace {

struct View {
  RobotConfig robot;
  Pose2 T_world_robot;
  const std::vector<std::uint8_t>& pixels;

  Eigen::Vector2d project(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector2d p = T_world_robot.inverse() * Eigen::Vector2d(p_world.head<2>());
    const CameraMount& m = robot.mount;
    const Eigen::Vector3d in_base(p.x() - m.x_m, p.y() - m.y_m, p_world.z() - m.z_m);
    return LensProjection(robot.lens).project(mount_rotation(m).transpose() * in_base).value();
  }

  double pixel(double u, double v) const {
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const double fu = u - i;
    const double fv = v - j;
    const auto at = [&](int x, int y) {
      return static_cast<double>(pixels[static_cast<std::size_t>(y) * 640 + x]);
    };
    return (1 - fv) * ((1 - fu) * at(i, j) + fu * at(i + 1, j)) +
           fv * ((1 - fu) * at(i, j + 1) + fu * at(i + 1, j + 1));
  }
};

// How far along `direction` from `at` the brightness crosses half way between its ends.
std::optional<double> edge_offset(const View& view, const Eigen::Vector2d& at,
                                  const Eigen::Vector2d& direction) {
  constexpr double kReach_px = 3.0;
  const auto value = [&](double s) {
    return view.pixel(at.x() + s * direction.x(), at.y() + s * direction.y());
  };
  const double low = value(-kReach_px);
  const double high = value(kReach_px);
  if (std::abs(high - low) < 30.0) return std::nullopt;
  const double half = 0.5 * (low + high);
  for (double s = -kReach_px; s < kReach_px; s += 0.02) {
    if ((value(s) - half) * (value(s + 0.02) - half) <= 0.0) return s + 0.01;
  }
  return std::nullopt;
}

// Points along the shining edges of all lamps within 65 degrees of the zenith; the edge in the
// picture must lie where the projection says. 0.2 px at worst, and no bias: the mean over more
// than 100 points has a standard error well below 0.01 px.
TEST(RenderedGeometry, LampEdgesLieWhereTheyProject) {
  const TestWorld file(exact_room());
  auto simulation = Simulation::load(file.path(), {});
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  RobotDrive drive = simulation->drive(0);
  SimFrame frame;
  std::vector<CanFrame> can;
  ASSERT_TRUE(drive.next(frame, can));
  const View view{drive.truth(), frame.T_world_robot, frame.pixels};
  const World& world = simulation->world();
  const RoomLayout layout = lay_out_room(world.file.rooms[0], world.seed, 0);
  constexpr double kRim_m = 0.02;
  int count = 0;
  double sum = 0.0;
  double worst = 0.0;
  for (const Lamp& lamp : layout.lamps) {
    const Rect& r = lamp.rect;
    const Eigen::Vector2d corners[4] = {{r.x0 + kRim_m, r.y0 + kRim_m},
                                        {r.x1 - kRim_m, r.y0 + kRim_m},
                                        {r.x1 - kRim_m, r.y1 - kRim_m},
                                        {r.x0 + kRim_m, r.y1 - kRim_m}};
    for (int side = 0; side < 4; ++side) {
      const Eigen::Vector2d a = corners[side];
      const Eigen::Vector2d b = corners[(side + 1) % 4];
      const Eigen::Vector2d along = (b - a).normalized();
      const Eigen::Vector2d inward(-along.y(), along.x());
      for (double f = 0.25; f <= 0.76; f += 0.05) {
        const Eigen::Vector2d p = a + f * (b - a);
        const auto at_height = [](const Eigen::Vector2d& q) {
          return Eigen::Vector3d(q.x(), q.y(), 2.6);
        };
        const Eigen::Vector2d uv = view.project(at_height(p));
        const Eigen::Vector2d inside = view.project(at_height(p + 0.01 * inward));
        if ((uv - Eigen::Vector2d(320, 240)).norm() > 150.0) continue;
        const auto offset = edge_offset(view, uv, (inside - uv).normalized());
        ASSERT_TRUE(offset.has_value()) << "no edge at " << uv.transpose();
        ++count;
        sum += *offset;
        worst = std::max(worst, std::abs(*offset));
      }
    }
  }
  ASSERT_GT(count, 100);
  EXPECT_LT(worst, 0.2);
  EXPECT_LT(std::abs(sum / count), 0.03);
}

struct Hit {
  FacetId facet = kNoFacet;
  double margin_m = 0.0;  // to the facet's nearest border
};

// The nearest facet along a ray, by trying all of them; only faces that look at the ray.
Hit cast(const FloorPlan& plan, const Eigen::Vector3d& from, const Eigen::Vector3d& d) {
  double nearest = std::numeric_limits<double>::infinity();
  Hit hit;
  for (std::size_t i = 0; i < plan.facets().size(); ++i) {
    const Facet& f = plan.facets()[i];
    if (f.owner == FacetOwner::kDoor && f.axis != 2) {
      // The two sides of a door's rectangle that lie in the walls' planes are open.
      const Eigen::Vector3d at = from + d * ((f.offset - from[f.axis]) / d[f.axis]);
      const Eigen::Vector3d beyond = at + 0.01 * d.normalized();
      if (plan.cell(plan.column(beyond.x()), plan.row(beyond.y())).height > 0.0F) continue;
    }
    const double t = (f.offset - from[f.axis]) / d[f.axis];
    if (!(t > 1e-9) || t >= nearest) continue;
    const Eigen::Vector3d p = from + t * d;
    const double a = f.axis == 0 ? p.y() : p.x();
    const double b = f.axis == 2 ? p.y() : p.z();
    double margin = std::min(std::min(a - f.a0, f.a1 - a), std::min(b - f.b0, f.b1 - b));
    if (margin < 0.0) continue;
    bool open = false;
    for (std::uint32_t h = 0; h < f.hole_count; ++h) {
      const Hole& hole = plan.holes(f)[h];
      const double in = std::min(std::min(a - hole.a0, hole.a1 - a), hole.b1 - b);
      open = open || in > 0.0;
      margin = std::min(margin, std::abs(in));
    }
    if (open) continue;
    nearest = t;
    hit = {static_cast<FacetId>(i), margin};
  }
  return hit;
}

// 20 000 random directions in every world. The skyline's azimuths are 0.09 degrees wide and boxes
// hide what is a hair beyond them, so directions near a border are decided by the neighbours'
// agreement: a direction counts when a ring of rays around it hits the same facet.
TEST(Skyline, AgreesWithBruteForce) {
  for (const std::string& name : list_worlds()) {
    const auto file = load_world_file(find_world(name));
    ASSERT_TRUE(file.ok());
    const auto plan = FloorPlan::build(*file);
    ASSERT_TRUE(plan.ok());
    Random random(77);
    Skyline skyline;
    int compared = 0;
    for (int place = 0; place < 10; ++place) {
      const auto& path = file->robots[0].path;
      const Eigen::Vector2d at = path[random.below(static_cast<std::uint32_t>(path.size()))];
      const Eigen::Vector3d eye(at.x() + random.uniform(-0.1, 0.1),
                                at.y() + random.uniform(-0.1, 0.1), 0.3);
      skyline.look(*plan, eye.x(), eye.y(), eye.z(), -1e9F);
      for (int i = 0; i < 250; ++i) {
        const double turn = random.uniform();
        const double angle = turn * 2.0 * std::numbers::pi;
        const double elevation = random.uniform(-0.2, 1.5);
        const auto ray = [&](double da, double de) {
          return Eigen::Vector3d(std::cos(elevation + de) * std::cos(angle + da),
                                 std::cos(elevation + de) * std::sin(angle + da),
                                 std::sin(elevation + de));
        };
        const Hit hit = cast(*plan, eye, ray(0.0, 0.0));
        bool same = true;
        for (const double da : {-0.002, 0.002}) {
          for (const double de : {-0.002, 0.0, 0.002}) {
            same = same && cast(*plan, eye, ray(da, de)).facet == hit.facet;
          }
        }
        if (!same) continue;
        ++compared;
        const FacetId seen =
            skyline.facet(static_cast<float>(turn), static_cast<float>(std::tan(elevation)));
        ASSERT_EQ(seen, hit.facet)
            << name << " from " << eye.transpose() << " towards " << angle << ", " << elevation;
      }
    }
    EXPECT_GT(compared, 2000);
  }
}

TEST(RenderedGeometry, LimitedViewIsTheSamePictureWithinItsCircle) {
  const TestWorld file(exact_room());
  const auto render = [&](double angle_deg) {
    auto simulation = Simulation::load(file.path(), {.seed = 3, .max_view_angle_deg = angle_deg});
    SimFrame frame;
    std::vector<CanFrame> can;
    EXPECT_TRUE(simulation->drive(0).next(frame, can));
    return frame.pixels;
  };
  const auto whole = render(180.0);
  const auto part = render(60.0);
  int differing = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double r = std::hypot(u - 320.0, v - 240.0);
      const std::size_t i = static_cast<std::size_t>(v) * 640 + u;
      if (r < 150.0 && whole[i] != part[i]) ++differing;
      if (r > 160.0) {
        ASSERT_EQ(part[i], 0) << u << ", " << v;
      }
    }
  }
  EXPECT_EQ(differing, 0);
}

}  // namespace
}  // namespace zenith::sim
