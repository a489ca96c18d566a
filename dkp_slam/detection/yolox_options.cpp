#include "dkp_slam/detection/yolox_options.h"

#include "dkp_slam/config/option_list.h"

namespace dkp_slam {

void yolox::DecodeOptions::describe(OptionList& list) {
  list.add("lowest_score", lowest_score, between(0, 1), "", "weaker boxes are dropped");
  list.add("nms_iou", nms_iou, between(0, 1), "",
           "of two boxes of one class that overlap by more the weaker one goes");
}

void yolox::DecodeOptions::check() const { check_options(*this); }

void YoloxOptions::describe(OptionList& list) {
  list.add("model", model, "file (.onnx); '': DKP_SLAM_MODEL, models/ or ~/.cache/dkp-slam");
  list.add("backend", backend,
           {{YoloxBackend::automatic, "auto"},
            {YoloxBackend::onnxruntime, "onnxruntime"},
            {YoloxBackend::opencv, "opencv"}},
           "library that runs the network");
  list.add("provider", provider, {{"cpu", "cpu"}, {"cuda", "cuda"}, {"tensorrt", "tensorrt"}},
           "execution provider of ONNX Runtime");
  list.add("threads", threads, between(1, 256), "", "of the network");
  list.add_part("looks", looks, "which images it looks at");
  list.add_part("decode", decode, "boxes from its output");
  list.leave_out();  // the classes: a file of their own
}

void YoloxOptions::check() const { check_options(*this); }

}  // namespace dkp_slam
