#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

/// Procedural CV_8UC3 images for a furnished place: what its surfaces are made of ...
/// Same random state, same bytes. Sizes in texels; `metre` is how many of them make a metre.
cv::Mat plaster_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre);
cv::Mat wallpaper_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre);
cv::Mat carpet_tiles_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre);
cv::Mat parquet_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double metre);
cv::Mat tiles_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double side,
                    double metre);
cv::Mat rug_print(cv::RNG& rng, cv::Size size);
cv::Mat grain_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat weave_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat smooth_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat ceiling_print(cv::RNG& rng, cv::Size size, double metre);
cv::Mat leaf_print(cv::RNG& rng, cv::Size size);

/// ... and what people put on them.
cv::Mat landscape_print(cv::RNG& rng, cv::Size size);
cv::Mat chart_print(cv::RNG& rng, cv::Size size);
cv::Mat page_print(cv::RNG& rng, cv::Size size);
cv::Mat whiteboard_print(cv::RNG& rng, cv::Size size);
cv::Mat cork_board_print(cv::RNG& rng, cv::Size size);
cv::Mat editor_print(cv::RNG& rng, cv::Size size);
cv::Mat browser_print(cv::RNG& rng, cv::Size size);
cv::Mat keyboard_print(cv::RNG& rng, cv::Size size);
cv::Mat book_spine_print(cv::RNG& rng, cv::Size size);
cv::Mat binder_spine_print(cv::RNG& rng, cv::Size size);
cv::Mat cardboard_print(cv::RNG& rng, cv::Size size);
cv::Mat street_print(cv::RNG& rng, cv::Size size);
cv::Mat door_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat cabinet_front_print(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, int columns,
                            int rows);
/// One of landscapes, charts and abstract pictures.
cv::Mat any_poster_print(cv::RNG& rng, cv::Size size);

/// A colour out of `darkest`..`brightest`, half as saturated as three random channels would be.
cv::Scalar room_colour(cv::RNG& rng, int darkest = 50, int brightest = 215);
/// A line of made-up words, as high as `box`, cut off at its right edge.
void write_words(cv::RNG& rng, cv::Mat* image, const cv::Rect& box, const cv::Scalar& colour);

}  // namespace dkp_slam
