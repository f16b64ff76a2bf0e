#pragma once
// From a scene and a moving camera to radiance per pixel.
//
// A pixel's value is the mean over 4 samples spread over the pixel and over the exposure, each read
// from the mip level whose texels are about half a pixel, so one mechanism does anti-aliasing and
// motion blur. Inside a facet the hit of the pixel's centre is exact and the samples follow by its
// derivative; where facets meet, 8 samples are each tested against the facets around.

#include <vector>

#include "sim/camera.h"
#include "sim/floor_plan.h"
#include "sim/scene.h"
#include "sim/skyline.h"

namespace zenith::sim {

// The camera in the middle of the exposure, and how much it moves and turns over all of it.
struct CameraMotion {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.3;
  double yaw_rad = 0.0;
  double dx_m = 0.0;
  double dy_m = 0.0;
  double dyaw_rad = 0.0;
};

class Renderer {
 public:
  // All must outlive it.
  Renderer(const FloorPlan& plan, const Scene& scene, const Camera& camera);

  // Radiance times vignetting, rows of the camera's width; 0 where nothing is rendered. Valid
  // until the next call.
  const std::vector<float>& render(const CameraMotion& motion);

 private:
  struct Eye;
  void find_facets(double yaw_rad);
  void shade_row(const Eye& eye, int row);
  float shade_inside(const Eye& eye, const PixelRay& ray, FacetId id) const;
  float shade_edge(const Eye& eye, const PixelRay& ray, const FacetId* around, int count) const;

  const FloorPlan& plan_;
  const Scene& scene_;
  const Camera& camera_;
  Skyline skyline_;
  std::vector<FacetId> facets_;  // per pixel, with a rim of one pixel
  std::vector<float> radiance_;
};

}  // namespace zenith::sim
