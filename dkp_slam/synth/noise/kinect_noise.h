#pragma once

#include <opencv2/core.hpp>

#include "dkp_slam/geometry/camera.h"

namespace dkp_slam {

/// What a structured-light sensor makes of a true depth image (CV_32FC1, metres): disparity noise
/// that neighbours share, disparities in eighths of a pixel, edges displaced by about half a pixel,
/// shadows that the projector (`camera.baseline` to the right) cannot light, holes at depth edges,
/// nothing nearer than 0.4 m, and beyond 4.5 m ever fewer readings. Pixels are those of an image
/// 640 wide: in metres the noise is the same at any size.
/// After Khoshelham and Elberink 2012 and Handa et al. 2014 ("A Benchmark for RGB-D Visual
/// Odometry, 3D Reconstruction and SLAM", §III-B). 0 where unknown.
cv::Mat kinect_depth(const cv::Mat& depth, const Camera& camera, cv::RNG& rng);

/// Adds the mild noise of a colour sensor, in place: `sigma` grey levels, independent per pixel.
void add_image_noise(cv::Mat* colour, double sigma, cv::RNG& rng);

}  // namespace dkp_slam
