#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"
#include "dkp_slam/synth/light/light_map.h"
#include "dkp_slam/synth/render/edge_marks.h"
#include "dkp_slam/synth/render/rendering.h"
#include "dkp_slam/synth/render/shading.h"
#include "dkp_slam/synth/tracing/actor_reach.h"
#include "dkp_slam/synth/tracing/embree_scene.h"
#include "dkp_slam/synth/tracing/shutter.h"

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
  /// Memory that frames use one after the other: to get it anew for each takes time.
  struct Buffers {
    std::vector<SeenPoint> seen;  ///< of each pixel, row by row
    cv::Mat samples;              ///< of `EdgeMarks`
    /// At every twelfth pixel: what is seen there, and its light lost to actors; below 0: unknown.
    std::vector<SeenPoint> shadow_points;
    cv::Mat shadows;  ///< CV_32FC1
  };

  /// `buffers` must outlive it and serve one painter at a time.
  FramePainter(const LitScene& scene, const Camera& camera, const PixelRays& pixels,
               const Shutter& shutter, const LampBrightness& brightness, int samples,
               Buffers* buffers);

  Rendering paint();

 private:
  /// How a pixel sees what its centre's ray met.
  struct CentreView {
    Eigen::Vector2f motion = Eigen::Vector2f::Zero();  ///< as in `SeenPoint`
    bool in_shadow = false;
    Shading::Filter filter;
  };
  /// One of the rays of a pixel on an edge.
  struct EdgeSample {
    cv::Point pixel;
    float weight;
    PixelLight light;
    cv::Vec3f centre;  ///< what the centre's ray brought to the pixel, weighted
  };
  /// Rays that may meet the same things, of one row of tiles.
  struct EdgePacket {
    EmbreeScene::Among among;
    int count = 0;
    Rays rays;
    std::array<EdgeSample, packet_size> samples;
  };

  template <class Work>
  void over_rows(int rows, const Work& work) const;
  SeenPoint& seen(int x, int y) {
    return buffers_.seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                         static_cast<std::size_t>(x)];
  }
  Ray centre_ray(int x, int y) const;
  /// The rays through the centres of these pixels meet this.
  EmbreeScene::Among among(const cv::Rect& pixels) const;
  void trace_shadows(int grid_y);
  bool in_shadow(int x, int y) const;
  float shadow_at(int x, int y, const SeenPoint& here) const;
  void paint_centres(int tile_y, Rendering* out);
  CentreView view(int x, int y, const SurfaceHit& hit, const HitPlane& plane, const Ray& ray) const;
  void paint_nothing(int x, int y, Rendering* out);
  void paint_centre(int x, int y, const SurfaceHit& hit, const HitPlane& plane,
                    const CentreView& view, Rendering* out);
  Eigen::Vector2f image_motion(const HitPlane& plane, const RowExposure& row) const;
  void paint_edges(int tile_y, Rendering* out);
  void paint_edge(const cv::Point& pixel, std::vector<EdgePacket>* packets, HitPlanes* planes,
                  Rendering* out);
  /// `share` of the row's exposure has passed.
  Ray edge_ray(int x, int y, const Eigen::Vector2f& offset, float share) const;
  void shade_packet(EdgePacket* packet, HitPlanes* planes, Rendering* out);

  const LitScene scene_;
  const Camera& camera_;
  const PixelRays& pixels_;
  const Shutter& shutter_;
  std::vector<float> row_brightness_;
  const ActorReach actors_;
  Buffers& buffers_;
  EdgeMarks edges_;
};

}  // namespace dkp_slam
