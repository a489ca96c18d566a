#include "dkp_slam/synth/render/frame_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <opencv2/core/utility.hpp>

#include "dkp_slam/synth/light/actor_light.h"

namespace dkp_slam {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int edge_taps = 2;              // across a slanted view: several samples share the work
constexpr int shadow_step = 12;           // pixels between points where actors' shadows are traced
constexpr float same_plane = 0.04F;       // metres: points of one surface share their shadow
constexpr float sample_footprint = 0.6F;  // of a pixel: several samples share it
constexpr int tile_side = 4;              // pixels: of a packet of rays through their centres
static_assert(tile_side * tile_side == packet_size && shadow_step % tile_side == 0);
constexpr int most_samples = EdgeMarks::most_samples;

/// A number in 0..1 that looks random, the same for the same pixel.
float pixel_share(int x, int y) {
  auto h =
      static_cast<std::uint32_t>(x) * 0x9E3779B1U ^ static_cast<std::uint32_t>(y) * 0x85EBCA77U;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12U)) * 0x297A2D39U;
  return static_cast<float>((h ^ (h >> 15U)) >> 8U) * 0x1p-24F;
}

bool same_triangle(const SurfaceHit& a, const SurfaceHit& b) {
  return a.surface == b.surface && a.triangle == b.triangle;
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
      actors_(scene.embree, camera, shutter),
      buffers_(*buffers),
      edges_({camera.width, camera.height}, samples, &buffers->samples) {
  buffers_.seen.resize(static_cast<std::size_t>(camera.width) * camera.height);
  buffers_.shadows.release();
  for (int y = 0; y < camera.height; ++y) {
    row_brightness_.push_back(brightness ? static_cast<float>(brightness(shutter.row(y).time))
                                         : 1.0F);
  }
}

template <class Work>
void FramePainter::over_rows(int rows, const Work& work) const {
  cv::parallel_for_({0, rows}, [&](const cv::Range& range) {
    for (int y = range.start; y < range.end; ++y) work(y);
  });
}

Rendering FramePainter::paint() {
  Rendering out;
  out.radiance.create(camera_.height, camera_.width, CV_32FC3);
  out.depth.create(camera_.height, camera_.width, CV_32FC1);
  out.instance.create(camera_.height, camera_.width, CV_8UC1);
  if (scene_.embree.surfaces() > scene_.embree.still_surfaces() && !scene_.lamps.none()) {
    buffers_.shadows.create((camera_.height - 1) / shadow_step + 2,
                            (camera_.width - 1) / shadow_step + 2, CV_32FC1);
    buffers_.shadow_points.resize(buffers_.shadows.total());
    over_rows(buffers_.shadows.rows, [&](int y) { trace_shadows(y); });
  }
  const int tile_rows = (camera_.height - 1) / tile_side + 1;
  over_rows(tile_rows, [&](int y) { paint_centres(y, &out); });
  over_rows(camera_.height, [&](int y) { edges_.mark_row(y, buffers_.seen, out.radiance); });
  over_rows(tile_rows, [&](int y) { paint_edges(y, &out); });
  return out;
}

Ray FramePainter::centre_ray(int x, int y) const {
  const RowExposure& row = shutter_.row(y);
  return {row.middle.origin, row.middle.rotation * pixels_.at(x, y)};
}

EmbreeScene::Among FramePainter::among(const cv::Rect& pixels) const {
  if (!actors_.touches(pixels)) return {};
  return {.moment = scene_.embree.moment_at(shutter_.moment(shutter_.row(pixels.y).time))};
}

void FramePainter::trace_shadows(int grid_y) {
  const int y = std::min(grid_y * shadow_step, camera_.height - 1);
  const auto pixel = [&](int grid_x) { return std::min(grid_x * shadow_step, camera_.width - 1); };
  HitPlanes planes(scene_.embree);
  const int columns = buffers_.shadows.cols;
  for (int first = 0; first < columns; first += packet_size) {
    const int count = std::min(packet_size, columns - first);
    Rays rays;
    for (int i = 0; i < count; ++i) {
      rays[static_cast<std::size_t>(i)] = centre_ray(pixel(first + i), y);
    }
    const int left = pixel(first), right = pixel(first + count - 1);
    const SurfaceHits hits =
        scene_.embree.trace(rays, count, among({left, y, right - left + 1, 1}));
    for (int i = 0; i < count; ++i) {
      const SurfaceHit& hit = hits[static_cast<std::size_t>(i)];
      const int grid_x = first + i;
      float& lost = buffers_.shadows.at<float>(grid_y, grid_x);
      SeenPoint& point =
          buffers_.shadow_points[static_cast<std::size_t>(grid_y * columns + grid_x)];
      lost = -1.0F;
      point.surface = hit.surface;
      if (hit.surface < 0 || scene_.embree.surface(hit.surface).instance != 0) continue;
      const HitPlane& plane = planes.at(hit, rays[static_cast<std::size_t>(i)]);
      point.point = plane.point;
      const Mesh& mesh = *scene_.embree.surface(hit.surface).mesh;
      const int vertex = mesh.triangles[static_cast<std::size_t>(hit.triangle)][0];
      const Vector3f& outside = mesh.rest.normals[static_cast<std::size_t>(vertex)];
      const Vector3f normal =
          plane.normal.dot(outside) < 0.0F ? Vector3f(-plane.normal) : plane.normal;
      lost = light_lost_to_actors(scene_.embree, scene_.lamps, plane.point, normal);
    }
  }
}

/// Whether any of the four points around the pixel loses light. The same all over a tile.
bool FramePainter::in_shadow(int x, int y) const {
  if (buffers_.shadows.empty()) return false;
  const int grid_x = x / shadow_step, grid_y = y / shadow_step;
  const auto* above = buffers_.shadows.ptr<float>(grid_y) + grid_x;
  const auto* below = buffers_.shadows.ptr<float>(grid_y + 1) + grid_x;
  return std::max({above[0], above[1], below[0], below[1]}) > 0.0F;
}

/// Between the four points around, as far as they lie on the pixel's own surface.
float FramePainter::shadow_at(int x, int y, const SeenPoint& here) const {
  const int grid_x = x / shadow_step, grid_y = y / shadow_step;
  const float a = static_cast<float>(x % shadow_step) / shadow_step;
  const float b = static_cast<float>(y % shadow_step) / shadow_step;
  float sum = 0.0F, weights = 0.0F, any = 0.0F, any_weights = 0.0F;
  for (int i = 0; i < 4; ++i) {
    const int gx = grid_x + i % 2, gy = grid_y + i / 2;
    const float lost = buffers_.shadows.at<float>(gy, gx);
    if (lost < 0.0F) continue;
    const SeenPoint& there =
        buffers_.shadow_points[static_cast<std::size_t>(gy * buffers_.shadows.cols + gx)];
    const float weight = (i % 2 == 0 ? 1.0F - a : a) * (i / 2 == 0 ? 1.0F - b : b) + 1e-4F;
    any += weight * lost;
    any_weights += weight;
    if (here.surface < 0) continue;
    const float off = here.normal.dot(there.point - here.point);
    if (std::abs(off) > same_plane) continue;
    sum += weight * lost;
    weights += weight;
  }
  if (weights > 0.0F) return sum / weights;
  return any_weights > 0.0F ? any / any_weights : 0.0F;
}

/// In squares of pixels: their rays stay closer together than those along a row.
void FramePainter::paint_centres(int tile_y, Rendering* out) {
  HitPlanes planes(scene_.embree);
  Rays rays;
  for (int x0 = 0; x0 < camera_.width; x0 += tile_side) {
    const cv::Rect tile(x0, tile_y * tile_side, tile_side, tile_side);
    const auto pixel = [&](int i) { return tile.tl() + cv::Point(i % tile_side, i / tile_side); };
    const auto outside = [&](cv::Point p) { return p.x >= camera_.width || p.y >= camera_.height; };
    for (int i = 0; i < packet_size; ++i) {
      const cv::Point p = outside(pixel(i)) ? tile.tl() : pixel(i);
      rays[static_cast<std::size_t>(i)] = centre_ray(p.x, p.y);
    }
    const SurfaceHits hits = scene_.embree.trace(rays, packet_size, among(tile));
    std::array<CentreView, packet_size> views;
    for (int i = 0; i < packet_size; ++i) {
      const cv::Point p = pixel(i);
      if (outside(p)) continue;
      const auto lane = static_cast<std::size_t>(i);
      const SurfaceHit& hit = hits[lane];
      if (hit.surface < 0) {
        paint_nothing(p.x, p.y, out);
        continue;
      }
      const HitPlane& plane = planes.at(hit, rays[lane]);
      // Over a few pixels of one triangle the view of it hardly changes.
      const auto like =
          std::find_if(std::make_reverse_iterator(hits.begin() + i), hits.rend(),
                       [&](const SurfaceHit& other) { return same_triangle(other, hit); });
      views[lane] = like == hits.rend() ? view(p.x, p.y, hit, plane, rays[lane])
                                        : views[static_cast<std::size_t>(hits.rend() - like) - 1];
      paint_centre(p.x, p.y, hit, plane, views[lane], out);
    }
  }
}

void FramePainter::paint_nothing(int x, int y, Rendering* out) {
  seen(x, y).surface = -1;
  seen(x, y).motion = Vector2f::Zero();
  out->radiance.at<cv::Vec3f>(y, x) = {0.0F, 0.0F, 0.0F};
  out->instance.at<std::uint8_t>(y, x) = 0;
  out->depth.at<float>(y, x) = 0.0F;
}

void FramePainter::paint_centre(int x, int y, const SurfaceHit& hit, const HitPlane& plane,
                                const CentreView& view, Rendering* out) {
  seen(x, y) = {hit.surface, hit.triangle, plane.point, plane.normal, view.motion};
  const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)],
                            view.in_shadow ? shadow_at(x, y, seen(x, y)) : 0.0F};
  out->radiance.at<cv::Vec3f>(y, x) = scene_.shading.colour(hit, plane.uv, view.filter, light);
  out->instance.at<std::uint8_t>(y, x) =
      static_cast<std::uint8_t>(scene_.embree.surface(hit.surface).instance);
  // The directions' z is 1 in the camera's frame: their lengths count as depth.
  out->depth.at<float>(y, x) = hit.distance;
}

FramePainter::CentreView FramePainter::view(int x, int y, const SurfaceHit& hit,
                                            const HitPlane& plane, const Ray& ray) const {
  const RowExposure& row = shutter_.row(y);
  CentreView view;
  if (shutter_.exposure() > 0.0) view.motion = image_motion(plane, row);
  const Footprint print =
      footprint(plane, hit.distance, ray.direction, row.middle.turn(pixels_.right(x, y)),
                row.middle.turn(pixels_.down(x, y)), view.motion);
  view.in_shadow = in_shadow(x, y);
  view.filter = scene_.shading.filter(hit.surface, print, view.motion);
  return view;
}

Vector2f FramePainter::image_motion(const HitPlane& plane, const RowExposure& row) const {
  const auto share =
      static_cast<float>(0.5 * shutter_.exposure() / (shutter_.end() - shutter_.begin()));
  const Vector2f way = row.end.project(plane.point + share * plane.travel) -
                       row.begin.project(plane.point - share * plane.travel);
  return {way.x() * static_cast<float>(camera_.fx), way.y() * static_cast<float>(camera_.fy)};
}

Ray FramePainter::edge_ray(int x, int y, const Vector2f& offset, float share) const {
  const RowExposure& row = shutter_.row(y);
  const Vector2f aside = offset.x() * pixels_.right(x, y) + offset.y() * pixels_.down(x, y);
  const Vector3f direction = pixels_.at(x, y) + Vector3f(aside.x(), aside.y(), 0.0F);
  // The camera turns by a degree at most meanwhile: between the two ends it is as good as straight.
  return {
      (1.0F - share) * row.begin.origin + share * row.end.origin,
      (1.0F - share) * (row.begin.rotation * direction) + share * (row.end.rotation * direction)};
}

/// Tile by tile, so that rays which fill a packet together lie close to each other.
void FramePainter::paint_edges(int tile_y, Rendering* out) {
  HitPlanes planes(scene_.embree);
  // Of rays that no actor can meet, and of those at each moment.
  std::vector<EdgePacket> packets(static_cast<std::size_t>(scene_.embree.moments()) + 1);
  for (int i = 0; i <= scene_.embree.moments(); ++i) {
    packets[static_cast<std::size_t>(i)].among.moment = i - 1;
  }
  const int y0 = tile_y * tile_side, end = std::min(y0 + tile_side, camera_.height);
  for (int x0 = 0; x0 < camera_.width; x0 += tile_side) {
    for (int y = y0; y < end; ++y) {
      for (int x = x0; x < std::min(x0 + tile_side, camera_.width); ++x) {
        if (edges_.row(y)[x] > 1) paint_edge({x, y}, &packets, &planes, out);
      }
    }
  }
  for (EdgePacket& packet : packets) shade_packet(&packet, &planes, out);
}

/// The centre's ray counts as one of a pixel's samples. The others share out the exposure, each
/// somewhere in its part, and are spread over the pixel; those of several pixels fill a packet.
void FramePainter::paint_edge(const cv::Point& pixel, std::vector<EdgePacket>* packets,
                              HitPlanes* planes, Rendering* out) {
  static const SampleOffsets offsets;
  const int x = pixel.x, y = pixel.y;
  const RowExposure& row = shutter_.row(y);
  const int samples = edges_.row(y)[x], others = samples - 1;
  const float weight = 1.0F / static_cast<float>(samples);
  const PixelLight light = {row_brightness_[static_cast<std::size_t>(y)],
                            in_shadow(x, y) ? shadow_at(x, y, seen(x, y)) : 0.0F};
  const bool actors = actors_.touches({x, y, 1, 1});
  const float jitter = shutter_.exposure() > 0.0 ? pixel_share(x, y) : 0.5F;
  cv::Vec3f& radiance = out->radiance.at<cv::Vec3f>(pixel);
  radiance *= weight;
  const cv::Vec3f centre = radiance;
  for (int k = 0; k < others; ++k) {
    const float share = (static_cast<float>(k) + jitter) / static_cast<float>(others);
    const double time = row.time + (share - 0.5) * shutter_.exposure();
    const int moment = actors ? scene_.embree.moment_at(shutter_.moment(time)) : -1;
    EdgePacket& packet = (*packets)[static_cast<std::size_t>(moment + 1)];
    const auto lane = static_cast<std::size_t>(packet.count++);
    packet.rays[lane] = edge_ray(x, y, offsets.at(k, others), share);
    packet.samples[lane] = {pixel, weight, light, centre};
    if (packet.count == packet_size) shade_packet(&packet, planes, out);
  }
}

/// Adds the packet's light to its pixels and empties it.
void FramePainter::shade_packet(EdgePacket* packet, HitPlanes* planes, Rendering* out) {
  if (packet->count == 0) return;
  const SurfaceHits hits = scene_.embree.trace(packet->rays, packet->count, packet->among);
  for (int i = 0; i < packet->count; ++i) {
    const auto lane = static_cast<std::size_t>(i);
    const SurfaceHit& hit = hits[lane];
    if (hit.surface < 0) continue;
    const Ray& ray = packet->rays[lane];
    const EdgeSample& sample = packet->samples[lane];
    const int x = sample.pixel.x, y = sample.pixel.y;
    cv::Vec3f& radiance = out->radiance.at<cv::Vec3f>(y, x);
    const HitPlane& plane = planes->at(hit, ray);
    const SeenPoint& centre = seen(x, y);
    // The centre's colour is that of all of its surface in the pixel (as in multisampling).
    if (hit.surface == centre.surface &&
        !is_edge(centre, {hit.surface, hit.triangle, plane.point, plane.normal, {}})) {
      radiance += sample.centre;
      continue;
    }
    const CameraPlace& place = shutter_.row(y).middle;
    const Footprint print = footprint(
        plane, hit.distance, ray.direction, sample_footprint * place.turn(pixels_.right(x, y)),
        sample_footprint * place.turn(pixels_.down(x, y)), Vector2f::Zero());
    const Shading::Filter filter = scene_.shading.filter(hit.surface, print, edge_taps);
    radiance += sample.weight * scene_.shading.colour(hit, plane.uv, filter, sample.light);
  }
  packet->count = 0;
}

}  // namespace dkp_slam
