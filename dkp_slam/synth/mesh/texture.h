#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace dkp_slam {

/// An image on a surface, filtered so that it does not alias: trilinear in a pyramid, with several
/// taps along the longer axis of a pixel's footprint.
class Texture {
 public:
  /// `bgr` is CV_8UC3. With `wrap`, the left and right edges meet (cloth around a limb); its width
  /// should be a power of two then.
  explicit Texture(const cv::Mat& bgr, bool wrap = false);

  /// How a pixel sees the texture: good for its neighbours on the same plane as well.
  struct Filter {
    std::size_t level;     ///< of the pyramid
    float coarser = 0.0F;  ///< share of the level above it
    int taps = 1;
    Eigen::Vector2f axis;  ///< the longer one of the footprint, along which the taps lie
  };
  /// `du` and `dv` are the changes of uv from one pixel of the camera to the next, right and down.
  /// More taps than 6 only matter on floors seen at a few degrees.
  Filter filter(const Eigen::Vector2f& du, const Eigen::Vector2f& dv, int most_taps = 6) const;
  /// BGR, 0 to 255, at `uv` (0 to 1 over the image).
  cv::Vec3f sample(const Eigen::Vector2f& uv, const Filter& filter) const;
  cv::Vec3f sample(const Eigen::Vector2f& uv, const Eigen::Vector2f& du,
                   const Eigen::Vector2f& dv) const {
    return sample(uv, filter(du, dv));
  }
  cv::Vec3f sample(const Eigen::Vector2d& uv, const Eigen::Vector2d& du,
                   const Eigen::Vector2d& dv) const {
    return sample(uv.cast<float>().eval(), du.cast<float>().eval(), dv.cast<float>().eval());
  }
  /// Of the whole image, BGR, 0 to 255.
  cv::Vec3f mean() const;

 private:
  struct Level {
    int width, height;
    /// Row by row; blue, green, red from the lowest byte on. Each row ends with one texel more,
    /// what lies right of its last one, so that neighbours are always read together.
    std::vector<std::uint32_t> texels;
  };
  /// Four numbers that the processor handles at once (GCC's and Clang's vector extension).
  using Float4 = float __attribute__((vector_size(16)));
  /// In units of 1/256 grey level.
  Float4 bilinear(const Level& level, float u, float v) const;

  std::vector<Level> levels_;
  bool wrap_;
};

/// Linear light, 0 to 1, of a grey level, 0 to 255, in sRGB (IEC 61966-2-1).
class LinearLight {
 public:
  LinearLight();
  float operator()(float level) const {
    const float in_range = level < 0.0F ? 0.0F : level > 255.0F ? 255.0F : level;
    return table_[static_cast<int>(in_range * parts + 0.5F)];
  }

 private:
  /// Of a grey level between two entries: the power function would take a third of the shading.
  static constexpr int parts = 16;
  const float* table_;
};
float linear_light(float level);

}  // namespace dkp_slam
