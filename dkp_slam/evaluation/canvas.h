#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace dkp_slam {

/// An opaque colour, 0 to 255 each.
struct Colour {
  int red = 0;
  int green = 0;
  int blue = 0;
};

enum class TextAnchor { start, middle, end };

/// A white page to draw a figure on. Positions and widths in points, origin at the top left corner,
/// y down. What is drawn later covers what was drawn earlier.
class Canvas {
 public:
  using Line = std::vector<Eigen::Vector2d>;

  virtual ~Canvas() = default;

  /// Open lines, all alike. A line of fewer than two points is nothing.
  virtual void lines(const std::vector<Line>& lines, Colour colour, double width) = 0;
  /// A filled rectangle without a border.
  virtual void rectangle(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                         Colour colour) = 0;
  /// A picture (CV_8UC3, BGR) stretched over a rectangle.
  virtual void image(const Eigen::Vector2d& top_left, const Eigen::Vector2d& size,
                     const cv::Mat& picture) = 0;
  /// Text with its baseline's start, middle or end at `at`; `size` is the font's.
  virtual void text(const Eigen::Vector2d& at, const std::string& text, double size,
                    TextAnchor anchor, Colour colour) = 0;
  /// The finished figure: the bytes of a file.
  virtual std::string encode() const = 0;
};

/// Scalable Vector Graphics.
std::unique_ptr<Canvas> svg_canvas(int width, int height);
/// PNG with two pixels a point. Text is ASCII only; other characters become '?'.
std::unique_ptr<Canvas> png_canvas(int width, int height);

/// Text for XML and HTML, between tags as in attributes: & < > " ' are replaced, control characters
/// but tab and line feed, which XML forbids even when escaped, become '?'.
std::string escaped(const std::string& text);

/// A picture (CV_8UC3, BGR) as the value of an image's address in HTML or SVG: a JPEG within the
/// text, so that no other file is needed. `quality` 1 to 100. Throws `Error` when it cannot be
/// encoded.
std::string data_uri(const cv::Mat& picture, int quality = 88);

}  // namespace dkp_slam
