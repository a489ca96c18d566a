#include "dkp_slam/evaluation/canvas.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/jpeg_codec.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam {
namespace {

std::string base64(const std::vector<uchar>& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? digits[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(int width, int height) {
    body_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
        "{1}\" font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" "
        "fill=\"#ffffff\"/>\n",
        width, height);
  }

  void lines(const std::vector<Line>& lines, Colour colour, double width) override {
    std::string path;
    for (const Line& line : lines) {
      if (line.size() < 2) continue;
      for (std::size_t i = 0; i < line.size(); ++i) {
        fmt::format_to(std::back_inserter(path), "{}{:.2f} {:.2f}", i == 0 ? "M" : "L", line[i].x(),
                       line[i].y());
      }
    }
    if (path.empty()) return;
    fmt::format_to(std::back_inserter(body_),
                   "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
                   "stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n",
                   path, hex(colour), width);
  }

  void rectangle(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                 Colour colour) override {
    fmt::format_to(
        std::back_inserter(body_),
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n",
        top_left.x(), top_left.y(), size.x(), size.y(), hex(colour));
  }

  void image(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
             const cv::Mat& picture) override {
    fmt::format_to(std::back_inserter(body_),
                   "<image x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
                   "preserveAspectRatio=\"none\" href=\"{}\"/>\n",
                   top_left.x(), top_left.y(), size.x(), size.y(), data_uri(picture));
  }

  void text(const Eigen::Vector2d& at, const std::string& text, double size, TextAnchor anchor,
            Colour colour) override {
    const char* name = anchor == TextAnchor::start    ? "start"
                       : anchor == TextAnchor::middle ? "middle"
                                                      : "end";
    fmt::format_to(std::back_inserter(body_),
                   "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:g}\" text-anchor=\"{}\" "
                   "fill=\"{}\">{}</text>\n",
                   at.x(), at.y(), size, name, hex(colour), escaped(text));
  }

  std::string encode() const override { return body_ + "</svg>\n"; }

 private:
  static std::string hex(Colour c) {
    return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue);
  }

  std::string body_;
};

// Drawn larger and scaled down: OpenCV's own smoothing leaves lines and letters ragged.
constexpr int pixels_per_point = 2;
constexpr int oversampling = 3;
constexpr double raster_scale = pixels_per_point * oversampling;
// Positions are given to OpenCV with this many binary digits after the point.
constexpr int shift = 3;

class PngCanvas : public Canvas {
 public:
  PngCanvas(int width, int height)
      : image_(static_cast<int>(height * raster_scale), static_cast<int>(width * raster_scale),
               CV_8UC3, cv::Scalar::all(255)) {}

  void lines(const std::vector<Line>& lines, Colour colour, double width) override {
    for (const Line& line : lines) {
      if (line.size() < 2) continue;
      std::vector<cv::Point> points;
      points.reserve(line.size());
      for (const Eigen::Vector2d& point : line) points.push_back(fixed_point(point));
      cv::polylines(image_, points, false, bgr(colour), pixels(width), cv::LINE_8, shift);
    }
  }

  void rectangle(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                 Colour colour) override {
    cv::rectangle(image_, box(top_left, size), bgr(colour), cv::FILLED);
  }

  void image(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
             const cv::Mat& picture) override {
    const cv::Rect whole = box(top_left, size);
    const cv::Rect seen = whole & cv::Rect(0, 0, image_.cols, image_.rows);
    if (seen.empty()) return;
    cv::Mat stretched;
    cv::resize(picture, stretched, whole.size(), 0, 0, cv::INTER_CUBIC);
    stretched(seen - whole.tl()).copyTo(image_(seen));
  }

  void text(const Eigen::Vector2d& at, const std::string& text, double size, TextAnchor anchor,
            Colour colour) override {
    std::string ascii = text;
    std::replace_if(
        ascii.begin(), ascii.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
    // The font is 22 pixels from the baseline to the top of a capital at scale 1, which is about
    // 0.7 of what is called a font's size elsewhere.
    const double scale = 0.7 * size * raster_scale / 22.0;
    const int thickness = pixels(0.095 * size);
    int below = 0;
    const cv::Size extent =
        cv::getTextSize(ascii, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &below);
    cv::Point origin(static_cast<int>(std::lround(at.x() * raster_scale)),
                     static_cast<int>(std::lround(at.y() * raster_scale)));
    if (anchor == TextAnchor::middle) origin.x -= extent.width / 2;
    if (anchor == TextAnchor::end) origin.x -= extent.width;
    cv::putText(image_, ascii, origin, cv::FONT_HERSHEY_SIMPLEX, scale, bgr(colour), thickness,
                cv::LINE_8);
  }

  std::string encode() const override {
    cv::Mat small;
    cv::resize(image_, small, cv::Size(image_.cols / oversampling, image_.rows / oversampling), 0,
               0, cv::INTER_AREA);
    const std::vector<std::uint8_t> bytes = encode_png(small, PngSize::small);
    return {bytes.begin(), bytes.end()};
  }

 private:
  static cv::Scalar bgr(Colour c) { return {double(c.blue), double(c.green), double(c.red)}; }
  static int pixels(double width) {
    return std::max(1, static_cast<int>(std::lround(width * raster_scale)));
  }
  static cv::Rect box(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size) {
    const auto whole = [](const Eigen::Vector2d& v) {
      return cv::Point(static_cast<int>(std::lround(v.x() * raster_scale)),
                       static_cast<int>(std::lround(v.y() * raster_scale)));
    };
    return {whole(top_left), whole(top_left + size)};
  }
  static cv::Point fixed_point(const Eigen::Vector2d& point) {
    const Eigen::Vector2d scaled = point * raster_scale * (1 << shift);
    return {static_cast<int>(std::lround(scaled.x())), static_cast<int>(std::lround(scaled.y()))};
  }

  cv::Mat image_;
};

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default: {
        const bool control = static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
        result += control ? '?' : c;
      }
    }
  }
  return result;
}

std::string data_uri(const cv::Mat& picture, int quality) {
  return "data:image/jpeg;base64," + base64(encode_jpeg(picture, quality));
}

std::unique_ptr<Canvas> svg_canvas(int width, int height) {
  return std::make_unique<SvgCanvas>(width, height);
}

std::unique_ptr<Canvas> png_canvas(int width, int height) {
  return std::make_unique<PngCanvas>(width, height);
}

}  // namespace dkp_slam
