#pragma once

#include <opencv2/core.hpp>

namespace dkp_slam {

/// A CV_8UC3 image of one colour. The constructor of cv::Mat fills it a pixel at a time: that was
/// a fifth of the making of a world.
cv::Mat plain_image(cv::Size size, const cv::Scalar& colour);

/// Procedural CV_8UC3 images for the synthetic world's surfaces, with corners at many scales and
/// the moderate contrast of a room. Same random state, same bytes.
cv::Mat paint_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour, double roughness);
cv::Mat wood_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat carpet_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
cv::Mat checks_pattern(cv::RNG& rng, cv::Size size, int cell);
cv::Mat poster_pattern(cv::RNG& rng, cv::Size size);
cv::Mat books_pattern(cv::RNG& rng, cv::Size size, int shelf_height);
cv::Mat screen_pattern(cv::RNG& rng, cv::Size size);
/// Cloth that closes around a limb: plaid and a few printed marks.
cv::Mat cloth_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& colour);
/// Around a head: a face with eyes, brows and mouth in the middle column, hair behind and above.
cv::Mat head_pattern(cv::RNG& rng, cv::Size size, const cv::Scalar& skin, const cv::Scalar& hair);
/// Adds noise of several octaves, `amplitude` grey levels strong, in place.
void add_octaves(cv::RNG& rng, cv::Mat* image, double amplitude, cv::Size coarsest_cells = {8, 8});
/// The same, its left and right edges meeting.
void add_wrapped_octaves(cv::RNG& rng, cv::Mat* image, double amplitude, cv::Size coarsest_cells);

}  // namespace dkp_slam
