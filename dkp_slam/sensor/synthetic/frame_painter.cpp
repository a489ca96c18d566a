#include "dkp_slam/sensor/synthetic/frame_painter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/sensor/synthetic/actor_light.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int most_samples = 16;          // of a pixel, however fast things move
constexpr int most_taps = 12;             // of a texture along its motion
constexpr int most_filter_taps = 6;       // of a texture across a slanted view
constexpr int few_taps = 2;               // of them, where several samples share the work
constexpr float facet_cosine = 0.85F;     // triangles of one surface that meet at a sharper edge
constexpr float facet_slope = 0.5F;       // or lie this far off each other's plane are an edge
constexpr int shadow_step = 8;            // pixels between points where actors' shadows are traced
constexpr float same_plane = 0.04F;       // metres: points of one surface share their shadow
constexpr float sample_footprint = 0.6F;  // of a pixel: several samples share it

/// A number in 0..1 that looks random, the same for the same pixel.
float pixel_share(int x, int y) {
  auto h =
      static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12U)) * 0x297A2D39U;
  return static_cast<float>((h ^ (h >> 15U)) >> 8U) * 0x1p-24F;
}

/// Place of a sample in its pixel, -1/2..1/2: the sequence of Roberts 2018 ("The unreasonable
/// effectiveness of quasirandom sequences"), which fills a square evenly for any count.
Vector2f sample_offset(int k) {
  const double a = 0.5 + 0.7548776662466927 * (k + 1), b = 0.5 + 0.5698402909980532 * (k + 1);
  return {static_cast<float>(a - std::floor(a) - 0.5), static_cast<float>(b - std::floor(b) - 0.5)};
}

}  // namespace

FramePainter::FramePainter(const LitScene& scene, const Camera& camera, const PixelRays& pixels,
                           const Shutter& shutter, const LampBrightness& brightness, int samples)
    : scene_(scene),
      camera_(camera),
      pixels_(pixels),
      shutter_(shutter),
      samples_(samples),
      hits_(static_cast<std::size_t>(camera.width) * camera.height),
      samples_of_(camera.height, camera.width, CV_8UC1, cv::Scalar(1)) {
  for (int y = 0; y < camera.height; ++y) {
    row_brightness_.push_back(brightness ? static_cast<float>(brightness(shutter.row(y).time))
                                         : 1.0F);
  }
}

bool FramePainter::is_edge(const CentreHit& a, const CentreHit& b) {
  if (a.hit.surface != b.hit.surface) return true;
  if (a.hit.surface < 0 || a.hit.triangle == b.hit.triangle) return false;
  const Vector3f between = b.plane.point - a.plane.point;
  return std::abs(a.plane.normal.dot(b.plane.normal)) < facet_cosine ||
         std::abs(a.plane.normal.dot(between)) > facet_slope * between.norm();
}

template <class Work>
void FramePainter::over_rows(int rows, const Work& work) const {
  cv::parallel_for_({0, rows}, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) work(y);
  });
}

void FramePainter::frame_actors() {
  using Box = Eigen::AlignedBox3f;
  std::vector<Box> boxes;
  for (int i = scene_.embree.still_surfaces(); i < scene_.embree.surfaces(); ++i) {
    const Surface& surface = scene_.embree.surface(i);
    boxes.resize(static_cast<std::size_t>(surface.instance), Box());
    Box& box = boxes.back();
    for (const auto* vertices : {&surface.first, &surface.middle.vertices, &surface.last}) {
      for (const Vector3f& v : *vertices) box.extend(v);
    }
  }
  const int last = camera_.height - 1;
  const cv::Rect image(0, 0, camera_.width, camera_.height);
  // Between the moments looked at the camera may sway, and lenses bend.
  const float margin = camera_.distortion.none() ? 12.0F : 0.1F * static_cast<float>(camera_.width);
  for (const Box& box : boxes) {
    if (box.isEmpty()) continue;
    Vector2f low = Vector2f::Constant(1e9F), high = -low;
    bool around = false;
    for (const CameraPlace* place :
         {&shutter_.row(0).begin, &shutter_.row(last / 2).middle, &shutter_.row(last).end}) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3f point = box.corner(static_cast<Box::CornerType>(corner));
        constexpr float near_plane = 0.1F;
        around = around || place->depth(point) < near_plane;
        const Vector2f at = place->project(point);
        const Vector2f pixel(static_cast<float>(camera_.fx * at.x() + camera_.cx),
                             static_cast<float>(camera_.fy * at.y() + camera_.cy));
        low = low.cwiseMin(pixel);
        high = high.cwiseMax(pixel);
      }
    }
    if (around) {
      actors_.push_back(image);
      continue;
    }
    const auto bounded = [](float v) { return static_cast<int>(std::clamp(v, -1e6F, 1e6F)); };
    const cv::Point top(bounded(low.x() - margin), bounded(low.y() - margin));
    const cv::Point end(bounded(high.x() + margin) + 1, bounded(high.y() + margin) + 1);
    actors_.push_back(cv::Rect(top, end) & image);
  }
}

EmbreeScene::What FramePainter::reach(int x, int y, int count,
                                      EmbreeScene::What with_actors) const {
  const cv::Rect pixels(x, y, count, 1);
  const bool any = std::any_of(actors_.begin(), actors_.end(),
                               [&](const cv::Rect& r) { return !(r & pixels).empty(); });
  return any ? with_actors : EmbreeScene::What::still;
}

Rendering FramePainter::paint() {
  frame_actors();
  Rendering out;
  out.radiance.create(camera_.height, camera_.width, CV_32FC3);
  out.depth.create(camera_.height, camera_.width, CV_32FC1);
  out.instance.create(camera_.height, camera_.width, CV_8UC1);
  over_rows(camera_.height, [&](int y) { trace_centres(y, &out); });
  for (int y = 0; y < camera_.height; ++y) mark_edges(y);
  if (scene_.embree.surfaces() > scene_.embree.still_surfaces() && !scene_.lamps.none()) {
    shadows_.create((camera_.height - 1) / shadow_step + 2, (camera_.width - 1) / shadow_step + 2,
                    CV_32FC1);
    over_rows(shadows_.rows, [&](int y) { trace_shadows(y); });
  }
  over_rows(camera_.height, [&](int y) {
    const std::uint8_t* samples = samples_of_.ptr<std::uint8_t>(y);
    auto* radiance = out.radiance.ptr<cv::Vec3f>(y);
    for (int x = 0; x < camera_.width; ++x) {
      radiance[x] = samples[x] > 1 ? shade_samples(x, y, samples[x]) : shade_centre(x, y);
    }
  });
  return out;
}

Ray FramePainter::centre_ray(int x, int y) const {
  const RowExposure& row = shutter_.row(y);
  return {row.middle.origin, row.middle.rotation * pixels_.at(x, y), shutter_.moment(row.time)};
}

void FramePainter::trace_centres(int y, Rendering* out) {
  const RowExposure& row = shutter_.row(y);
  // All rows look at the middle of the frame's time when no shutter rolls.
  const bool rolling = shutter_.row(0).time != shutter_.row(camera_.height - 1).time;
  const auto actors =
      rolling ? EmbreeScene::What::still_and_moving : EmbreeScene::What::still_and_frozen;
  for (int x0 = 0; x0 < camera_.width; x0 += packet_size) {
    const int count = std::min(packet_size, camera_.width - x0);
    Rays rays;
    for (int i = 0; i < count; ++i) rays[static_cast<std::size_t>(i)] = centre_ray(x0 + i, y);
    const SurfaceHits hits = scene_.embree.trace(rays, count, reach(x0, y, count, actors));
    for (int i = 0; i < count; ++i) {
      const SurfaceHit& hit = hits[static_cast<std::size_t>(i)];
      CentreHit& c = centre(x0 + i, y);
      c.hit = hit;
      // The directions' z is 1 in the camera's frame: their lengths count as depth.
      out->depth.at<float>(y, x0 + i) = hit.surface < 0 ? 0.0F : hit.distance;
      out->instance.at<std::uint8_t>(y, x0 + i) =
          hit.surface < 0 ? std::uint8_t{0}
                          : static_cast<std::uint8_t>(scene_.embree.surface(hit.surface).instance);
      if (hit.surface < 0) continue;
      c.plane = hit_plane(scene_.embree, hit, rays[static_cast<std::size_t>(i)]);
      if (shutter_.exposure() > 0.0) c.motion = image_motion(c.plane, row);
    }
  }
}

Vector2f FramePainter::image_motion(const HitPlane& plane, const RowExposure& row) const {
  const auto share =
      static_cast<float>(0.5 * shutter_.exposure() / (shutter_.end() - shutter_.begin()));
  const Vector2f way = row.end.project(plane.point + share * plane.travel) -
                       row.begin.project(plane.point - share * plane.travel);
  return {way.x() * static_cast<float>(camera_.fx), way.y() * static_cast<float>(camera_.fy)};
}

/// Pixels that an edge touches during the exposure get several rays.
void FramePainter::mark_edges(int y) {
  for (int x = 0; x < camera_.width; ++x) {
    const CentreHit& here = centre(x, y);
    if (x + 1 < camera_.width && is_edge(here, centre(x + 1, y))) {
      mark(x, y, here.motion);
      mark(x + 1, y, centre(x + 1, y).motion);
    }
    if (y + 1 < camera_.height && is_edge(here, centre(x, y + 1))) {
      mark(x, y, here.motion);
      mark(x, y + 1, centre(x, y + 1).motion);
    }
  }
}

void FramePainter::mark(int x, int y, const Vector2f& motion) {
  // What comes from behind the camera's plane may seem to move without bound.
  constexpr float farthest = 64.0F;
  const float length = std::min(motion.norm(), farthest);
  const int samples =
      std::clamp(static_cast<int>(std::ceil(length)), samples_, std::max(samples_, most_samples));
  const int steps = static_cast<int>(std::ceil(length));
  for (int i = 0; i <= steps; ++i) {
    const float along =
        steps == 0 ? 0.0F : static_cast<float>(i) / static_cast<float>(steps) - 0.5F;
    const float share = motion.norm() > 0.0F ? along * length / motion.norm() : 0.0F;
    const int at_x = x + cvRound(share * motion.x()), at_y = y + cvRound(share * motion.y());
    if (at_x < 0 || at_y < 0 || at_x >= camera_.width || at_y >= camera_.height) continue;
    auto& most = samples_of_.at<std::uint8_t>(at_y, at_x);
    most = std::max(most, static_cast<std::uint8_t>(samples));
  }
}

void FramePainter::trace_shadows(int grid_y) {
  const int y = std::min(grid_y * shadow_step, camera_.height - 1);
  for (int grid_x = 0; grid_x < shadows_.cols; ++grid_x) {
    const CentreHit& c = centre(std::min(grid_x * shadow_step, camera_.width - 1), y);
    float& lost = shadows_.at<float>(grid_y, grid_x);
    lost = -1.0F;
    if (c.hit.surface < 0 || scene_.embree.surface(c.hit.surface).instance != 0) continue;
    const Mesh& mesh = *scene_.embree.surface(c.hit.surface).mesh;
    const int vertex = mesh.triangles[static_cast<std::size_t>(c.hit.triangle)][0];
    const Vector3f& outside = mesh.rest.normals[static_cast<std::size_t>(vertex)];
    const Vector3f normal =
        c.plane.normal.dot(outside) < 0.0F ? Vector3f(-c.plane.normal) : c.plane.normal;
    lost = light_lost_to_actors(scene_.embree, scene_.lamps, c.plane.point, normal);
  }
}

/// Between the four points around, as far as they lie on the pixel's own surface.
float FramePainter::shadow_at(int x, int y) {
  if (shadows_.empty()) return 0.0F;
  const CentreHit& here = centre(x, y);
  const int grid_x = x / shadow_step, grid_y = y / shadow_step;
  const float a = static_cast<float>(x % shadow_step) / shadow_step;
  const float b = static_cast<float>(y % shadow_step) / shadow_step;
  float sum = 0.0F, weights = 0.0F, any = 0.0F, any_weights = 0.0F;
  for (int i = 0; i < 4; ++i) {
    const int gx = grid_x + i % 2, gy = grid_y + i / 2;
    const float lost = shadows_.at<float>(gy, gx);
    if (lost < 0.0F) continue;
    const CentreHit& there = centre(std::min(gx * shadow_step, camera_.width - 1),
                                    std::min(gy * shadow_step, camera_.height - 1));
    const float weight = (i % 2 == 0 ? 1.0F - a : a) * (i / 2 == 0 ? 1.0F - b : b) + 1e-4F;
    any += weight * lost;
    any_weights += weight;
    if (here.hit.surface < 0) continue;
    const float off = here.plane.normal.dot(there.plane.point - here.plane.point);
    if (std::abs(off) > same_plane) continue;
    sum += weight * lost;
    weights += weight;
  }
  if (weights > 0.0F) return sum / weights;
  return any_weights > 0.0F ? any / any_weights : 0.0F;
}

cv::Vec3f FramePainter::shade_centre(int x, int y) {
  const CentreHit& c = centre(x, y);
  if (c.hit.surface < 0) return {0.0F, 0.0F, 0.0F};
  const Eigen::Matrix3f& rotation = shutter_.row(y).middle.rotation;
  const Footprint print = footprint(c.plane, centre_ray(x, y), rotation * pixels_.right(x, y),
                                    rotation * pixels_.down(x, y), c.motion);
  const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)], shadow_at(x, y)};
  constexpr float still = 0.3F;  // pixels
  const float way = c.motion.norm();
  const int taps = way < still ? 1 : std::clamp(static_cast<int>(std::ceil(way)), 2, most_taps);
  // Where motion blurs the print there is no fine detail to lose across the view.
  return scene_.shading.colour(c.hit, c.plane.uv, print, taps,
                               taps > 1 ? few_taps : most_filter_taps, light);
}

/// Rays spread over the pixel and, stratified, over the exposure.
cv::Vec3f FramePainter::shade_samples(int x, int y, int samples) {
  const RowExposure& row = shutter_.row(y);
  const Vector3f centre = pixels_.at(x, y);
  const Vector3f right = pixels_.right(x, y), down = pixels_.down(x, y);
  const float jitter = shutter_.exposure() > 0.0 ? pixel_share(x, y) : 0.5F;
  const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)], shadow_at(x, y)};
  cv::Vec3f sum(0.0F, 0.0F, 0.0F);
  for (int first = 0; first < samples; first += packet_size) {
    const int count = std::min(packet_size, samples - first);
    Rays rays;
    for (int i = 0; i < count; ++i) {
      const Vector2f offset = sample_offset(first + i);
      const float share = (static_cast<float>(first + i) + jitter) / static_cast<float>(samples);
      const Vector3f direction = centre + offset.x() * right + offset.y() * down;
      // The camera turns by a degree at most meanwhile: between the two ends it is as good as
      // straight.
      rays[static_cast<std::size_t>(i)] = {
          (1.0F - share) * row.begin.origin + share * row.end.origin,
          (1.0F - share) * (row.begin.rotation * direction) +
              share * (row.end.rotation * direction),
          shutter_.moment(row.time + (share - 0.5) * shutter_.exposure())};
    }
    const SurfaceHits hits =
        scene_.embree.trace(rays, count, reach(x, y, 1, EmbreeScene::What::still_and_moving));
    for (int i = 0; i < count; ++i) {
      const SurfaceHit& hit = hits[static_cast<std::size_t>(i)];
      if (hit.surface < 0) continue;
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      const HitPlane plane = hit_plane(scene_.embree, hit, ray);
      const Footprint print =
          footprint(plane, ray, sample_footprint * (row.middle.rotation * right),
                    sample_footprint * (row.middle.rotation * down), Vector2f::Zero());
      sum += scene_.shading.colour(hit, plane.uv, print, 1, few_taps, light);
    }
  }
  return sum * (1.0F / static_cast<float>(samples));
}

}  // namespace dkp_slam
