#include "dkp_slam/dynamics/motion/lucas_kanade.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include <opencv2/video/tracking.hpp>

#include "dkp_slam/cpu.h"

namespace dkp_slam {
namespace {

// Registers are passed between functions that are all inlined: there is no ABI to change.
#pragma GCC diagnostic ignored "-Wpsabi"

// Everything below is inlined into two functions, one for the baseline of x86-64 (or another
// processor) and one for AVX2. Both do the same operations in the same order, eight sums side by
// side and no fused multiply-add, so that results do not depend on the machine.
#define DKP_SLAM_INLINE inline __attribute__((always_inline))

constexpr std::size_t lanes = 8;
using EightFloats = float __attribute__((vector_size(32)));

/// Registers of the x86-64 baseline or of NEON.
struct Baseline {
  using Register = float __attribute__((vector_size(16)));
  using InMemory = float __attribute__((vector_size(16), aligned(4), may_alias));
};
struct Avx2 {
  using Register = EightFloats;
  using InMemory = float __attribute__((vector_size(32), aligned(4), may_alias));
};

/// Eight bytes as floats. Spelled out: converted at once the compiler takes them one by one, and
/// copied into a vector they would go through the stack.
DKP_SLAM_INLINE void to_floats(const std::uint8_t* from, float* to) {
  using Longs = std::uint64_t __attribute__((vector_size(16)));
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  using Shorts = std::uint16_t __attribute__((vector_size(16)));
  using Ints = std::int32_t __attribute__((vector_size(32)));
  std::uint64_t eight = 0;
  std::memcpy(&eight, from, lanes);
  const auto bytes = reinterpret_cast<Bytes>(Longs{eight, 0});
  const auto shorts = reinterpret_cast<Shorts>(__builtin_shufflevector(
      bytes, Bytes{}, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
  *reinterpret_cast<Avx2::InMemory*>(to) =
      __builtin_convertvector(__builtin_convertvector(shorts, Ints), EightFloats);
}

/// What is done with registers of one kind, `Baseline` or `Avx2`.
template <typename Kind>
struct Vector {
  using Register = typename Kind::Register;
  using InMemory = typename Kind::InMemory;
  static constexpr int size = sizeof(Register) / sizeof(float);

  static DKP_SLAM_INLINE Register load(const float* from) {
    return *reinterpret_cast<const InMemory*>(from);
  }
  static DKP_SLAM_INLINE void store(const Register& from, float* to) {
    *reinterpret_cast<InMemory*>(to) = from;
  }
  /// Between `from` and the values one further.
  static DKP_SLAM_INLINE Register interpolate(const float* from, float right) {
    const Register here = load(from);
    return here + right * (load(from + 1) - here);
  }
};

/// Eight sums, lane by lane, in one or two registers.
template <typename Kind>
struct Sums {
  using Register = typename Kind::Register;
  static constexpr std::size_t registers = lanes * sizeof(float) / sizeof(Register);
  Register part[registers] = {};

  /// Adds the products at columns `x` to `x` + the size of a register.
  DKP_SLAM_INLINE void add(int x, const Register& a, const Register& b) {
    part[static_cast<std::size_t>(x / Vector<Kind>::size) % registers] += a * b;
  }
  DKP_SLAM_INLINE float total() const {
    float lane[lanes];
    std::memcpy(lane, part, sizeof lane);
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) +
           ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  }
};

/// Rows of floats, with columns of zeros so that whole registers can be read.
class Rows {
 public:
  Rows(int width, int height)
      : stride_((static_cast<std::size_t>(width) + 2 * lanes - 1) / lanes * lanes),
        values_(stride_ * static_cast<std::size_t>(height)) {}
  float* row(int y) { return values_.data() + stride_ * static_cast<std::size_t>(y); }
  const float* row(int y) const { return values_.data() + stride_ * static_cast<std::size_t>(y); }

 private:
  std::size_t stride_;
  std::vector<float> values_;
};

/// A pixel and the way from it to a point.
struct Place {
  int x, y;
  float right, down;  // from 0 to 1

  explicit Place(const cv::Point2f& p)
      : x(cvFloor(p.x)),
        y(cvFloor(p.y)),
        right(p.x - static_cast<float>(x)),
        down(p.y - static_cast<float>(y)) {}
};

constexpr int play = 2;  // pixels that a window may move before its surroundings are read again

/// What the search of one point needs, and keeps from point to point.
class Searcher {
 public:
  Searcher(const LucasKanadeSearch& search)
      : search_(search),
        width_(search.window.width),
        height_(search.window.height),
        surroundings_(width_ + 1 + 2 * play, height_ + 1 + 2 * play),
        wide_(width_ + 2, height_ + 2),
        grey_(width_, height_),
        gradient_x_(width_, height_),
        gradient_y_(width_, height_) {}

  /// One point through all levels; false where it is not found.
  template <typename Kind>
  DKP_SLAM_INLINE bool find(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
                            const cv::Point2f& point, cv::Point2f& found) {
    const cv::Point2f half(0.5F * static_cast<float>(width_ - 1),
                           0.5F * static_cast<float>(height_ - 1));
    const int coarsest =
        std::min(search_.levels, static_cast<int>(std::min(from.size(), to.size())) - 1);
    bool ok = false;
    cv::Point2f at = found * (1.0F / static_cast<float>(1 << coarsest));
    for (int level = coarsest; level >= 0; --level) {
      const cv::Point2f origin = point * (1.0F / static_cast<float>(1 << level)) - half;
      cv::Point2f corner = at - half;
      // What a coarse level cannot say the next one may.
      ok = take_window<Kind>(from[static_cast<std::size_t>(level)], origin) &&
           descend<Kind>(to[static_cast<std::size_t>(level)], corner);
      at = corner + half;
      if (level > 0) at *= 2.0F;
    }
    found = at;
    return ok;
  }

 private:
  /// Whether a window there, with a pixel around it, lies in the image with its border.
  bool inside(const cv::Mat& image, const Place& corner) const {
    return corner.x > -width_ && corner.x < image.cols - 1 && corner.y > -height_ &&
           corner.y < image.rows - 1;
  }

  /// Where to begin reading for a window at `corner`: its surroundings lie in the border, too,
  /// which reaches as far beyond the image as the window is long.
  static int first_read(int corner, int window, int image) {
    return std::clamp(corner - play, -window, image - 1 - 2 * play);
  }

  /// `surroundings_` becomes the pixels from (`x`, `y`) on, `rows` of them and as many columns as a
  /// window needs to move.
  DKP_SLAM_INLINE void read_surroundings(const cv::Mat& image, int x, int y, int rows) {
    constexpr int step = lanes;
    const int width = width_ + 1 + 2 * play;
    for (int row = 0; row < rows; ++row) {
      const std::uint8_t* in = image.data + (y + row) * static_cast<std::ptrdiff_t>(image.step) + x;
      float* out = surroundings_.row(row);
      for (int column = 0; column + step <= width; column += step)
        to_floats(in + column, out + column);
      to_floats(in + width - step, out + width - step);
    }
  }

  /// Grey values and gradients (Scharr, grey levels per pixel) of the window at `origin`; false
  /// where they do not vary in two directions.
  template <typename Kind>
  DKP_SLAM_INLINE bool take_window(const cv::Mat& image, const cv::Point2f& origin) {
    const Place corner(origin);
    if (!inside(image, corner)) return false;
    const int left = first_read(corner.x, width_, image.cols);
    const int top = first_read(corner.y, height_, image.rows);
    read_surroundings(image, left, top, corner.y + height_ + 2 - top);
    using V = Vector<Kind>;
    const int row = corner.y - 1 - top, column = corner.x - 1 - left;
    for (int x = 0; x < width_ + 2; x += V::size) {
      auto over = V::interpolate(surroundings_.row(row) + column + x, corner.right);
      for (int y = 0; y < height_ + 2; ++y) {
        const auto under =
            V::interpolate(surroundings_.row(row + y + 1) + column + x, corner.right);
        V::store(over + corner.down * (under - over), wide_.row(y) + x);
        over = under;
      }
    }
    Tensor<Kind> tensor;
    for (int x = 0; x < width_; x += V::size) differentiate<Kind>(x, tensor);
    if (clear_outside(image, corner)) tensor = sum_tensor<Kind>();
    return invert(tensor.xx.total(), tensor.xy.total(), tensor.yy.total());
  }

  /// Structure tensor of a window, summed over its pixels.
  template <typename Kind>
  struct Tensor {
    Sums<Kind> xx, xy, yy;
    template <typename Register>
    DKP_SLAM_INLINE void add(int x, const Register& gx, const Register& gy) {
      xx.add(x, gx, gx);
      xy.add(x, gx, gy);
      yy.add(x, gy, gy);
    }
  };

  /// Of the columns from `x` on, as many as a register holds.
  template <typename Kind>
  DKP_SLAM_INLINE void differentiate(int x, Tensor<Kind>& tensor) {
    using V = Vector<Kind>;
    constexpr float side = 3.0F / 32.0F, middle = 10.0F / 32.0F;
    struct Row {
      typename V::Register left, middle, right;
      explicit DKP_SLAM_INLINE Row(const float* from)
          : left(V::load(from)), middle(V::load(from + 1)), right(V::load(from + 2)) {}
    };
    Row above(wide_.row(0) + x), here(wide_.row(1) + x);
    for (int y = 0; y < height_; ++y) {
      const Row below(wide_.row(y + 2) + x);
      const typename V::Register gx =
          side * ((above.right - above.left) + (below.right - below.left)) +
          middle * (here.right - here.left);
      const typename V::Register gy =
          side * ((below.left - above.left) + (below.right - above.right)) +
          middle * (below.middle - above.middle);
      V::store(here.middle, grey_.row(y) + x);
      V::store(gx, gradient_x_.row(y) + x);
      V::store(gy, gradient_y_.row(y) + x);
      tensor.add(x, gx, gy);
      above = here;
      here = below;
    }
  }

  /// Gradients beyond the window, to whole registers, and beyond the image count for nothing: the
  /// border mirrors what moves the other way. True where there are such.
  bool clear_outside(const cv::Mat& image, const Place& corner) {
    const int left = std::max(0, -corner.x), right = std::min(width_, image.cols - corner.x);
    const int top = std::max(0, -corner.y), bottom = std::min(height_, image.rows - corner.y);
    const int end =
        (width_ + static_cast<int>(lanes) - 1) / static_cast<int>(lanes) * static_cast<int>(lanes);
    if (left == 0 && right == end && top == 0 && bottom == height_) return false;
    for (int y = 0; y < height_; ++y) {
      const bool inside = y >= top && y < bottom;
      for (Rows* rows : {&gradient_x_, &gradient_y_}) {
        float* row = rows->row(y);
        std::fill(row, row + (inside ? left : end), 0.0F);
        std::fill(row + std::max(0, right), row + end, 0.0F);
      }
    }
    return true;
  }

  template <typename Kind>
  DKP_SLAM_INLINE Tensor<Kind> sum_tensor() const {
    Tensor<Kind> tensor;
    using V = Vector<Kind>;
    for (int x = 0; x < width_; x += V::size) {
      for (int y = 0; y < height_; ++y) {
        tensor.add(x, V::load(gradient_x_.row(y) + x), V::load(gradient_y_.row(y) + x));
      }
    }
    return tensor;
  }

  /// False where the grey values do not vary in two directions.
  bool invert(float xx, float xy, float yy) {
    // Smaller eigenvalue of a pixel's mean structure tensor, below which noise is all there is.
    constexpr float least = 0.1F;
    const float smaller = 0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0F * xy * xy));
    const float determinant = xx * yy - xy * xy;
    if (smaller < least * static_cast<float>(width_ * height_) || determinant <= 0.0F) return false;
    inverse_xx_ = yy / determinant;
    inverse_xy_ = -xy / determinant;
    inverse_yy_ = xx / determinant;
    return true;
  }

  /// Moves `at`, the corner of the window in `image`, to where the two look alike; false where it
  /// leaves the image.
  template <typename Kind>
  DKP_SLAM_INLINE bool descend(const cv::Mat& image, cv::Point2f& at) {
    cv::Point2f step_before;
    int left = 0, top = 0;
    for (int i = 0; i < search_.iterations; ++i) {
      const Place corner(at);
      if (!inside(image, corner)) return false;
      const bool near = i > 0 && corner.x >= left && corner.x <= left + 2 * play &&
                        corner.y >= top && corner.y <= top + 2 * play;
      if (!near) {
        left = first_read(corner.x, width_, image.cols);
        top = first_read(corner.y, height_, image.rows);
        read_surroundings(image, left, top, height_ + 1 + 2 * play);
      }
      const cv::Point2f step = newton_step<Kind>(corner, corner.x - left, corner.y - top);
      at += step;
      if (step.dot(step) <= search_.epsilon * search_.epsilon) return true;
      // To and fro about the minimum: between the two.
      const cv::Point2f back = step + step_before;
      if (i > 0 && std::abs(back.x) < 0.01F && std::abs(back.y) < 0.01F) {
        at -= 0.5F * step;
        return true;
      }
      step_before = step;
    }
    return true;
  }

  template <typename Kind>
  DKP_SLAM_INLINE cv::Point2f newton_step(const Place& corner, int x0, int y0) const {
    using V = Vector<Kind>;
    Sums<Kind> sum_x, sum_y;
    for (int x = 0; x < width_; x += V::size) {
      auto above = V::interpolate(surroundings_.row(y0) + x0 + x, corner.right);
      for (int y = 0; y < height_; ++y) {
        const auto below = V::interpolate(surroundings_.row(y0 + y + 1) + x0 + x, corner.right);
        const typename V::Register difference =
            above + corner.down * (below - above) - V::load(grey_.row(y) + x);
        sum_x.add(x, difference, V::load(gradient_x_.row(y) + x));
        sum_y.add(x, difference, V::load(gradient_y_.row(y) + x));
        above = below;
      }
    }
    const float x = sum_x.total(), y = sum_y.total();
    return {-(inverse_xx_ * x + inverse_xy_ * y), -(inverse_xy_ * x + inverse_yy_ * y)};
  }

  const LucasKanadeSearch& search_;
  const int width_, height_;
  Rows surroundings_;  // of the window, in whole pixels
  Rows wide_;          // the window of the first image with a pixel around it
  Rows grey_, gradient_x_, gradient_y_;
  float inverse_xx_ = 0.0F, inverse_xy_ = 0.0F, inverse_yy_ = 0.0F;  // of the structure tensor
};

struct Task {
  const std::vector<cv::Mat>& from;
  const std::vector<cv::Mat>& to;
  const std::vector<cv::Point2f>& points;
  std::vector<cv::Point2f>& found;
  std::vector<std::uint8_t>& tracked;
  const LucasKanadeSearch& search;

  template <typename Kind>
  DKP_SLAM_INLINE void find(const cv::Range& range) const {
    Searcher searcher(search);
    for (int n = range.start; n < range.end; ++n) {
      const auto i = static_cast<std::size_t>(n);
      tracked[i] = searcher.find<Kind>(from, to, points[i], found[i]) ? 1 : 0;
    }
  }
};

void find_baseline(const Task& task, const cv::Range& range) { task.find<Baseline>(range); }

#if defined(__x86_64__)
DKP_SLAM_AVX2 void find_avx2(const Task& task, const cv::Range& range) { task.find<Avx2>(range); }
#endif

void find_in(const Task& task, const cv::Range& range) {
#if defined(__x86_64__)
  if (have_avx2() && !task.search.baseline) {
    find_avx2(task, range);
    return;
  }
#endif
  find_baseline(task, range);
}

}  // namespace

void make_pyramid(const cv::Mat& image, const LucasKanadeSearch& search,
                  std::vector<cv::Mat>& pyramid) {
  constexpr bool with_gradients = false;
  // A copy of `image`, which is not ours to write to when the pyramid's memory is used again.
  constexpr bool reuse_input = false;
  cv::buildOpticalFlowPyramid(image, pyramid, search.window, search.levels, with_gradients,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, reuse_input);
}

std::vector<std::uint8_t> lucas_kanade(const std::vector<cv::Mat>& from,
                                       const std::vector<cv::Mat>& to,
                                       const std::vector<cv::Point2f>& points,
                                       std::vector<cv::Point2f>& found,
                                       const LucasKanadeSearch& search) {
  std::vector<std::uint8_t> tracked(points.size(), 0);
  const Task task{from, to, points, found, tracked, search};
  cv::parallel_for_(cv::Range(0, static_cast<int>(points.size())),
                    [&](const cv::Range& range) { find_in(task, range); });
  return tracked;
}

}  // namespace dkp_slam
