#include "dkp_slam/sensor/synthetic/frame_painter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/core/utility.hpp>

#include "dkp_slam/sensor/synthetic/actor_light.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int most_samples = 16;          // of a pixel, however fast things move
constexpr float still = 0.3F;             // pixels: a way over the exposure that none sees
constexpr float blurring = 2.0F;          // pixels: one that takes more than a pixel's filter
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

/// Places of samples in their pixel, -1/2..1/2 and 0 on average.
class SampleOffsets {
 public:
  /// The sequence of Roberts 2018 ("The unreasonable effectiveness of quasirandom sequences"),
  /// which fills a square evenly for any count.
  SampleOffsets() {
    for (int count = 1; count <= most_samples; ++count) {
      auto& offsets = offsets_[static_cast<std::size_t>(count)];
      Vector2f mean = Vector2f::Zero();
      for (int k = 0; k < count; ++k) {
        const double a = 0.7548776662466927 * (k + 1), b = 0.5698402909980532 * (k + 1);
        offsets[static_cast<std::size_t>(k)] = {static_cast<float>(a - std::floor(a)),
                                                static_cast<float>(b - std::floor(b))};
        mean += offsets[static_cast<std::size_t>(k)] / static_cast<float>(count);
      }
      for (Vector2f& offset : offsets) offset -= mean;
    }
  }
  const Vector2f& at(int sample, int count) const {
    return offsets_[static_cast<std::size_t>(count)][static_cast<std::size_t>(sample)];
  }

 private:
  std::array<std::array<Vector2f, most_samples>, most_samples + 1> offsets_;
};

}  // namespace

FramePainter::FramePainter(const LitScene& scene, const Camera& camera, const PixelRays& pixels,
                           const Shutter& shutter, const LampBrightness& brightness, int samples,
                           Buffers* buffers)
    : scene_(scene),
      camera_(camera),
      pixels_(pixels),
      shutter_(shutter),
      samples_(samples),
      buffers_(*buffers) {
  buffers_.hits.resize(static_cast<std::size_t>(camera.width) * camera.height);
  buffers_.samples.create(camera.height, camera.width, CV_8UC1);
  buffers_.samples.setTo(1);
  buffers_.shadows.release();
  for (int y = 0; y < camera.height; ++y) {
    row_brightness_.push_back(brightness ? static_cast<float>(brightness(shutter.row(y).time))
                                         : 1.0F);
  }
}

bool FramePainter::is_edge(const CentreHit& a, const CentreHit& b) {
  if (a.hit.surface != b.hit.surface) return true;
  if (a.hit.surface < 0 || a.hit.triangle == b.hit.triangle) return false;
  const Vector3f between = b.point - a.point;
  const float off = a.normal.dot(between);
  return std::abs(a.normal.dot(b.normal)) < facet_cosine ||
         off * off > facet_slope * facet_slope * between.squaredNorm();
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
    buffers_.shadows.create((camera_.height - 1) / shadow_step + 2,
                            (camera_.width - 1) / shadow_step + 2, CV_32FC1);
    over_rows(buffers_.shadows.rows, [&](int y) { trace_shadows(y); });
  }
  over_rows(camera_.height, [&](int y) {
    const std::uint8_t* samples = buffers_.samples.ptr<std::uint8_t>(y);
    auto* radiance = out.radiance.ptr<cv::Vec3f>(y);
    for (int x = 0; x < camera_.width; ++x) {
      if (samples[x] == 1) radiance[x] = shade_centre(x, y);
    }
    shade_edges(y, radiance);
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
  HitPlanes planes(scene_.embree);
  Rays rays;
  for (int x0 = 0; x0 < camera_.width; x0 += packet_size) {
    const int count = std::min(packet_size, camera_.width - x0);
    for (int i = 0; i < count; ++i) rays[static_cast<std::size_t>(i)] = centre_ray(x0 + i, y);
    const SurfaceHits hits = scene_.embree.trace(rays, count, reach(x0, y, count, actors));
    for (int i = 0; i < count; ++i) {
      const SurfaceHit& hit = hits[static_cast<std::size_t>(i)];
      const int x = x0 + i;
      CentreHit& c = centre(x, y);
      c.hit = hit;
      c.motion = Vector2f::Zero();
      // The directions' z is 1 in the camera's frame: their lengths count as depth.
      out->depth.at<float>(y, x) = hit.surface < 0 ? 0.0F : hit.distance;
      out->instance.at<std::uint8_t>(y, x) =
          hit.surface < 0 ? std::uint8_t{0}
                          : static_cast<std::uint8_t>(scene_.embree.surface(hit.surface).instance);
      if (hit.surface < 0) continue;
      const Ray& ray = rays[static_cast<std::size_t>(i)];
      const HitPlane plane = planes.at(hit, ray);
      if (shutter_.exposure() > 0.0) c.motion = image_motion(plane, row);
      c.point = plane.point;
      c.normal = plane.normal;
      c.uv = plane.uv;
      c.print = footprint(plane, hit.distance, ray.direction, row.middle.turn(pixels_.right(x, y)),
                          row.middle.turn(pixels_.down(x, y)), c.motion);
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
  // Half a pixel of the way to either side ends within the two pixels that meet at the edge.
  const float spread = std::max(length - 1.0F, 0.0F);
  const int steps = static_cast<int>(std::ceil(spread));
  for (int i = 0; i <= steps; ++i) {
    const float along =
        steps == 0 ? 0.0F : static_cast<float>(i) / static_cast<float>(steps) - 0.5F;
    const float share = motion.norm() > 0.0F ? along * spread / motion.norm() : 0.0F;
    const int at_x = x + cvRound(share * motion.x()), at_y = y + cvRound(share * motion.y());
    if (at_x < 0 || at_y < 0 || at_x >= camera_.width || at_y >= camera_.height) continue;
    auto& most = buffers_.samples.at<std::uint8_t>(at_y, at_x);
    most = std::max(most, static_cast<std::uint8_t>(samples));
  }
}

void FramePainter::trace_shadows(int grid_y) {
  const int y = std::min(grid_y * shadow_step, camera_.height - 1);
  for (int grid_x = 0; grid_x < buffers_.shadows.cols; ++grid_x) {
    const CentreHit& c = centre(std::min(grid_x * shadow_step, camera_.width - 1), y);
    float& lost = buffers_.shadows.at<float>(grid_y, grid_x);
    lost = -1.0F;
    if (c.hit.surface < 0 || scene_.embree.surface(c.hit.surface).instance != 0) continue;
    const Mesh& mesh = *scene_.embree.surface(c.hit.surface).mesh;
    const int vertex = mesh.triangles[static_cast<std::size_t>(c.hit.triangle)][0];
    const Vector3f& outside = mesh.rest.normals[static_cast<std::size_t>(vertex)];
    const Vector3f normal = c.normal.dot(outside) < 0.0F ? Vector3f(-c.normal) : c.normal;
    lost = light_lost_to_actors(scene_.embree, scene_.lamps, c.point, normal);
  }
}

/// Between the four points around, as far as they lie on the pixel's own surface.
float FramePainter::shadow_at(int x, int y) {
  if (buffers_.shadows.empty()) return 0.0F;
  const CentreHit& here = centre(x, y);
  const int grid_x = x / shadow_step, grid_y = y / shadow_step;
  const auto* above = buffers_.shadows.ptr<float>(grid_y) + grid_x;
  const auto* below = buffers_.shadows.ptr<float>(grid_y + 1) + grid_x;
  if (std::max({above[0], above[1], below[0], below[1]}) <= 0.0F) return 0.0F;
  const float a = static_cast<float>(x % shadow_step) / shadow_step;
  const float b = static_cast<float>(y % shadow_step) / shadow_step;
  float sum = 0.0F, weights = 0.0F, any = 0.0F, any_weights = 0.0F;
  for (int i = 0; i < 4; ++i) {
    const int gx = grid_x + i % 2, gy = grid_y + i / 2;
    const float lost = buffers_.shadows.at<float>(gy, gx);
    if (lost < 0.0F) continue;
    const CentreHit& there = centre(std::min(gx * shadow_step, camera_.width - 1),
                                    std::min(gy * shadow_step, camera_.height - 1));
    const float weight = (i % 2 == 0 ? 1.0F - a : a) * (i / 2 == 0 ? 1.0F - b : b) + 1e-4F;
    any += weight * lost;
    any_weights += weight;
    if (here.hit.surface < 0) continue;
    const float off = here.normal.dot(there.point - here.point);
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
  const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)], shadow_at(x, y)};
  const float way = c.motion.norm();
  if (way >= blurring) {
    // Where motion blurs the print there is no fine detail to lose across the view.
    const int taps = std::min(static_cast<int>(std::ceil(way)), most_taps);
    return scene_.shading.colour(c.hit, c.uv, c.print, taps, few_taps, light);
  }
  Footprint print = c.print;
  if (way > still) {
    // A short way only lengthens the pixel, by its variance.
    const Vector2f along = c.motion / way;
    const float length = std::sqrt(1.0F + way * way);
    print.right = length * (along.x() * c.print.right + along.y() * c.print.down);
    print.down = along.x() * c.print.down - along.y() * c.print.right;
  }
  return scene_.shading.colour(c.hit, c.uv, print, 1, most_filter_taps, light);
}

/// The pixel's share of the exposure and the pixel: stratified over the one, spread over the other.
Ray FramePainter::edge_ray(int x, int y, int sample, int samples) const {
  static const SampleOffsets offsets;
  const RowExposure& row = shutter_.row(y);
  const Vector2f& offset = offsets.at(sample, samples);
  const float jitter = shutter_.exposure() > 0.0 ? pixel_share(x, y) : 0.5F;
  const float share = (static_cast<float>(sample) + jitter) / static_cast<float>(samples);
  const Vector2f aside = offset.x() * pixels_.right(x, y) + offset.y() * pixels_.down(x, y);
  const Vector3f direction = pixels_.at(x, y) + Vector3f(aside.x(), aside.y(), 0.0F);
  // The camera turns by a degree at most meanwhile: between the two ends it is as good as straight.
  return {
      (1.0F - share) * row.begin.origin + share * row.end.origin,
      (1.0F - share) * (row.begin.rotation * direction) + share * (row.end.rotation * direction),
      shutter_.moment(row.time + (share - 0.5) * shutter_.exposure())};
}

/// The rays of several pixels share packets, which else would be half empty.
void FramePainter::shade_edges(int y, cv::Vec3f* radiance) {
  const auto* samples_of = buffers_.samples.ptr<std::uint8_t>(y);
  HitPlanes planes(scene_.embree);
  Rays rays;
  std::array<EdgeSample, packet_size> samples;
  int count = 0;
  for (int x = 0; x < camera_.width; ++x) {
    if (samples_of[x] <= 1) continue;
    const CentreHit& c = centre(x, y);
    const float weight = 1.0F / static_cast<float>(samples_of[x]);
    const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)], shadow_at(x, y)};
    radiance[x] = {0.0F, 0.0F, 0.0F};
    if (c.hit.surface >= 0) {
      const Footprint print = {sample_footprint * c.print.right, sample_footprint * c.print.down,
                               Vector2f::Zero()};
      radiance[x] = weight * scene_.shading.colour(c.hit, c.uv, print, 1, few_taps, light);
    }
    for (int k = 1; k < samples_of[x]; ++k) {
      rays[static_cast<std::size_t>(count)] = edge_ray(x, y, k - 1, samples_of[x] - 1);
      samples[static_cast<std::size_t>(count)] = {x, weight, light};
      if (++count < packet_size) continue;
      shade_rays(y, rays, samples, count, &planes, radiance);
      count = 0;
    }
  }
  if (count > 0) shade_rays(y, rays, samples, count, &planes, radiance);
}

void FramePainter::shade_rays(int y, const Rays& rays,
                              const std::array<EdgeSample, packet_size>& samples, int count,
                              HitPlanes* planes, cv::Vec3f* radiance) const {
  const int first = samples.front().x, last = samples[static_cast<std::size_t>(count - 1)].x;
  const SurfaceHits hits = scene_.embree.trace(
      rays, count, reach(first, y, last - first + 1, EmbreeScene::What::still_and_moving));
  const CameraPlace& place = shutter_.row(y).middle;
  for (int i = 0; i < count; ++i) {
    const SurfaceHit& hit = hits[static_cast<std::size_t>(i)];
    if (hit.surface < 0) continue;
    const Ray& ray = rays[static_cast<std::size_t>(i)];
    const EdgeSample& sample = samples[static_cast<std::size_t>(i)];
    const HitPlane plane = planes->at(hit, ray);
    const Footprint print =
        footprint(plane, hit.distance, ray.direction,
                  sample_footprint * place.turn(pixels_.right(sample.x, y)),
                  sample_footprint * place.turn(pixels_.down(sample.x, y)), Vector2f::Zero());
    radiance[sample.x] +=
        sample.weight * scene_.shading.colour(hit, plane.uv, print, 1, few_taps, sample.light);
  }
}

}  // namespace dkp_slam
