#include "dkp_slam/sensor/png_general.h"

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <new>
#include <vector>

#include <png.h>

#include "dkp_slam/sensor/pixel_limit.h"

namespace dkp_slam {
namespace {

/// A file on its way through libpng, which leaves its functions by longjmp when it finds an error:
/// all that outlives such a jump is kept here.
class Decoding {
 public:
  Decoding(std::span<const std::uint8_t> file, std::string* problem)
      : left_(file), problem_(problem) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](auto, auto) {});
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, &info_, nullptr);
      throw std::bad_alloc();
    }
  }
  ~Decoding() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Decoding(const Decoding&) = delete;
  Decoding& operator=(const Decoding&) = delete;

  /// What libpng gives for the file: the image's size and type.
  bool read_header(cv::Size* size, int* type) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, take);
    png_read_info(png_, info_);
    const bool grey = (png_get_color_type(png_, info_) & ~PNG_COLOR_MASK_ALPHA) == 0;
    const bool deep = grey && png_get_bit_depth(png_, info_) == 16;
    png_set_expand(png_);  // palettes, fewer than 8 bits
    png_set_strip_alpha(png_);
    png_set_bgr(png_);
    if (!deep) png_set_strip_16(png_);
    if (deep && std::endian::native == std::endian::little) png_set_swap(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    *size = cv::Size(static_cast<int>(png_get_image_width(png_, info_)),
                     static_cast<int>(png_get_image_height(png_, info_)));
    *type = deep ? CV_16UC1 : grey ? CV_8UC1 : CV_8UC3;
    return png_get_rowbytes(png_, info_) ==
           static_cast<std::size_t>(size->width) * CV_ELEM_SIZE(*type);
  }

  bool read_rows(std::vector<png_bytep>& rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    png_read_image(png_, rows.data());
    png_read_end(png_, nullptr);
    return true;
  }

 private:
  static void take(png_structp png, png_bytep out, std::size_t count) {
    auto* self = static_cast<Decoding*>(png_get_io_ptr(png));
    if (count > self->left_.size()) png_error(png, "truncated");
    std::copy_n(self->left_.begin(), count, out);
    self->left_ = self->left_.subspan(count);
  }

  [[noreturn]] static void on_error(png_structp png, png_const_charp reason) {
    auto* self = static_cast<Decoding*>(png_get_error_ptr(png));
    self->problem_->assign("damaged PNG (").append(reason).append(")");
    png_longjmp(png, 1);
  }

  std::span<const std::uint8_t> left_;
  std::string* problem_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

bool decode_any_png(std::span<const std::uint8_t> file, std::uint64_t most_pixels, cv::Mat* image,
                    std::string* problem) {
  Decoding decoding(file, problem);
  cv::Size size;
  int type = CV_8UC3;
  *problem = "damaged PNG (header)";
  if (!decoding.read_header(&size, &type)) return false;
  if (has_too_many_pixels(static_cast<std::uint64_t>(size.width),
                          static_cast<std::uint64_t>(size.height), most_pixels)) {
    *problem = too_many_pixels;
    return false;
  }
  image->create(size, type);
  std::vector<png_bytep> rows;
  for (int y = 0; y < size.height; ++y) rows.push_back(image->ptr(y));
  if (!decoding.read_rows(rows)) {
    image->release();
    return false;
  }
  problem->clear();
  return true;
}

}  // namespace dkp_slam
