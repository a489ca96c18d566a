#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/sensor/synthetic/embree_scene.h"
#include "dkp_slam/sensor/synthetic/light_map.h"
#include "dkp_slam/sensor/synthetic/renderer.h"
#include "dkp_slam/sensor/synthetic/shading.h"
#include "dkp_slam/sensor/synthetic/shutter.h"

namespace dkp_slam {

/// The world at the time of a frame.
struct LitScene {
  const EmbreeScene& embree;
  const Lamps& lamps;
  const Shading& shading;
};

/// Paints one frame. A ray through each pixel's centre gives depth and instance, and the colour
/// where the pixel sees one surface only: its texture is then averaged along the way on which it
/// moves through the pixel during the exposure. Where an edge passes, several rays do it: that one
/// and others, spread over the pixel and the exposure.
class FramePainter {
 public:
  /// What the ray through a pixel's centre found.
  struct CentreHit {
    SurfaceHit hit;
    Eigen::Vector3f point, normal;  ///< as in `HitPlane`
    Eigen::Vector2f uv;
    Footprint print;
    Eigen::Vector2f motion;  ///< in the image over the exposure, pixels
  };
  /// Memory that frames use one after the other: to get it anew for each takes time.
  struct Buffers {
    std::vector<CentreHit> hits;
    cv::Mat samples;  ///< CV_8UC1, rays of each pixel; 1: its centre's will do
    cv::Mat shadows;  ///< CV_32FC1, light lost to actors at every eighth pixel; below 0: unknown
  };

  /// `buffers` must outlive it and serve one painter at a time.
  FramePainter(const LitScene& scene, const Camera& camera, const PixelRays& pixels,
               const Shutter& shutter, const LampBrightness& brightness, int samples,
               Buffers* buffers);

  Rendering paint();

 private:
  /// One of the rays of a pixel on an edge.
  struct EdgeSample {
    int x;
    float weight;
    PixelLight light;
  };

  static bool is_edge(const CentreHit& a, const CentreHit& b);
  template <class Work>
  void over_rows(int rows, const Work& work) const;
  CentreHit& centre(int x, int y) {
    return buffers_.hits[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                         static_cast<std::size_t>(x)];
  }
  Ray centre_ray(int x, int y) const;
  void frame_actors();
  /// What rays through pixels x to x + `count` - 1 of row y may meet.
  EmbreeScene::What reach(int x, int y, int count, EmbreeScene::What with_actors) const;
  void trace_centres(int y, Rendering* out);
  Eigen::Vector2f image_motion(const HitPlane& plane, const RowExposure& row) const;
  void mark_edges(int y);
  void mark(int x, int y, const Eigen::Vector2f& motion);
  void trace_shadows(int grid_y);
  float shadow_at(int x, int y);
  cv::Vec3f shade_centre(int x, int y);
  void shade_edges(int y, cv::Vec3f* radiance);
  Ray edge_ray(int x, int y, int sample, int samples) const;
  void shade_rays(int y, const Rays& rays, const std::array<EdgeSample, packet_size>& samples,
                  int count, HitPlanes* planes, cv::Vec3f* radiance) const;

  const LitScene scene_;
  const Camera& camera_;
  const PixelRays& pixels_;
  const Shutter& shutter_;
  const int samples_;
  std::vector<float> row_brightness_;
  std::vector<cv::Rect> actors_;  ///< where in the image each of them is during the frame, at most
  Buffers& buffers_;
};

}  // namespace dkp_slam
