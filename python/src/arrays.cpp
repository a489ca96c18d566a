#include "python/src/arrays.h"

#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include "dkp_slam/export/trajectory.h"
#include "python/src/mailbox.h"

namespace dkp_slam::python {
namespace {

/// Of images over memory of Python's: gives the reference back when the last image is gone.
class BorrowedMemory final : public cv::MatAllocator {
 public:
  // An image that is to hold something else has memory of OpenCV's own.
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    leave_reference(static_cast<PyObject*>(data->userdata));
    delete data;
  }
};

/// Never destroyed: images may outlive static objects.
const BorrowedMemory& borrowed_memory() {
  static const auto* const memory = new BorrowedMemory;
  return *memory;
}

py::dtype dtype_of(int depth) {
  switch (depth) {
    case CV_8U:
      return py::dtype::of<std::uint8_t>();
    case CV_16U:
      return py::dtype::of<std::uint16_t>();
    default:
      return py::dtype::of<float>();
  }
}

bool holds(const py::array& array, int type) {
  const py::dtype dtype = array.dtype();
  // A bool is a byte of 0 or 1.
  const bool bytes = type == CV_8UC1 && dtype.kind() == 'b';
  const int channels = CV_MAT_CN(type);
  return (bytes || dtype.equal(dtype_of(CV_MAT_DEPTH(type)))) &&
         array.ndim() == (channels > 1 ? 3 : 2) && (channels == 1 || array.shape(2) == channels);
}

}  // namespace

void value_error(const std::string& text) { throw py::value_error(text); }

py::array array_named(const char* name, const py::object& object) {
  if (py::isinstance<py::array>(object)) return py::reinterpret_borrow<py::array>(object);
  throw py::type_error(fmt::format("{} is a {}; give a numpy array", name,
                                   std::string(py::str(py::type::of(object).attr("__name__")))));
}

std::string text_of(const py::array& array) {
  return fmt::format("{} of shape {}", std::string(py::str(array.dtype())),
                     std::string(py::str(array.attr("shape"))));
}

cv::Mat borrow(const char* name, const py::array& array, int type, const char* expected) {
  if (!holds(array, type)) {
    value_error(fmt::format("{} is {}; it must be {}", name, text_of(array), expected));
  }
  const auto rows = static_cast<int>(array.shape(0)), cols = static_cast<int>(array.shape(1));
  const auto pixel = static_cast<py::ssize_t>(CV_ELEM_SIZE(type));
  const bool channels_together =
      CV_MAT_CN(type) == 1 || array.strides(2) == static_cast<py::ssize_t>(CV_ELEM_SIZE1(type));
  if (!channels_together || array.strides(1) != pixel || array.strides(0) < pixel * cols) {
    value_error(
        fmt::format("the pixels of {} do not lie side by side in memory (strides {}); pass "
                    "numpy.ascontiguousarray({})",
                    name, std::string(py::str(array.attr("strides"))), name));
  }
  // Nobody writes to it.
  auto* const data = static_cast<std::uint8_t*>(const_cast<void*>(array.data()));
  const auto step = static_cast<std::size_t>(array.strides(0));
  cv::Mat image(rows, cols, type, data, step);
  auto* const memory = new cv::UMatData(&borrowed_memory());
  memory->data = memory->origdata = data;
  memory->size = step * static_cast<std::size_t>(rows);
  memory->userdata = py::object(array).release().ptr();
  image.u = memory;
  image.addref();
  return image;
}

py::array array_of(const cv::Mat& image, bool writeable) {
  std::vector<py::ssize_t> shape{image.rows, image.cols};
  std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(image.step[0]),
                                   static_cast<py::ssize_t>(image.elemSize())};
  if (image.channels() > 1) {
    shape.push_back(image.channels());
    strides.push_back(static_cast<py::ssize_t>(image.elemSize1()));
  }
  const py::capsule owner(new cv::Mat(image), [](void* p) { delete static_cast<cv::Mat*>(p); });
  py::array array(dtype_of(image.depth()), shape, strides, image.data, owner);
  if (!writeable) array.attr("flags").attr("writeable") = false;
  return array;
}

py::array_t<double> matrix_of(const Se3& pose) {
  py::array_t<double> array({4, 4});
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(array.mutable_data());
  matrix.setIdentity();
  matrix.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.translation;
  return array;
}

namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

/// Throws ValueError where it is no rigid motion.
Se3 rigid_motion(const std::string& name, const Matrix4& matrix) {
  // What single precision makes of a rotation is still one.
  constexpr double tolerance = 1e-4;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool rigid =
      matrix.allFinite() &&
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < tolerance &&
      rotation.determinant() > 0.0 &&
      (matrix.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).norm() < tolerance;
  if (!rigid) {
    value_error(name +
                " is no rigid motion: a rotation, a translation, and 0 0 0 1 in its last row");
  }
  return {Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>()};
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

Doubles doubles_named(const std::string& name, const py::handle& object) {
  auto array = Doubles::ensure(object);
  if (array) return array;
  PyErr_Clear();
  value_error(name + " holds no numbers");
}

}  // namespace

Se3 pose_of(const std::string& name, const py::object& matrix) {
  const Doubles array = doubles_named(name, matrix);
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    value_error(fmt::format("{} is {}; it must be of shape (4, 4)", name, text_of(array)));
  }
  return rigid_motion(name, Eigen::Map<const Matrix4>(array.data()));
}

py::object trajectory_object(const Trajectory& trajectory) {
  const auto count = static_cast<py::ssize_t>(trajectory.size());
  py::array_t<double> stamps(count), poses({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t i = 0; i < count; ++i) {
    const StampedPose& pose = trajectory[static_cast<std::size_t>(i)];
    stamps.mutable_at(i) = pose.timestamp;
    Eigen::Map<Matrix4> matrix(poses.mutable_data(i, 0, 0));
    matrix.setIdentity();
    matrix.topLeftCorner<3, 3>() = pose.world_from_camera.rotation.toRotationMatrix();
    matrix.topRightCorner<3, 1>() = pose.world_from_camera.translation;
  }
  return py::module_::import("dkp_slam._trajectory").attr("Trajectory")(stamps, poses);
}

Trajectory trajectory_of(const char* name, const py::object& object) {
  const bool path = py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__");
  if (path) return read_trajectory(object.cast<std::filesystem::path>());
  if (!py::isinstance<py::sequence>(object) || py::len(object) != 2) {
    throw py::type_error(fmt::format(
        "{} must be a dkp_slam.Trajectory, a pair (timestamps, poses) or a file's path", name));
  }
  const auto pair = py::reinterpret_borrow<py::sequence>(object);
  const Doubles stamps = doubles_named(fmt::format("{}.timestamps", name), pair[0]);
  const Doubles poses = doubles_named(fmt::format("{}.poses", name), pair[1]);
  if (stamps.ndim() != 1 || poses.ndim() != 3 || poses.shape(0) != stamps.shape(0) ||
      poses.shape(1) != 4 || poses.shape(2) != 4) {
    value_error(
        fmt::format("the time stamps of {} are {}, its poses {}; they must be of shapes (n,) and "
                    "(n, 4, 4)",
                    name, text_of(stamps), text_of(poses)));
  }
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < stamps.shape(0); ++i) {
    const double stamp = stamps.at(i);
    const bool rises = trajectory.empty() || stamp > trajectory.back().timestamp;
    if (!std::isfinite(stamp) || !rises) {
      value_error(
          fmt::format("{}.timestamps[{}] is {}; stamps must be numbers that rise", name, i, stamp));
    }
    const Eigen::Map<const Matrix4> matrix(poses.data(i, 0, 0));
    trajectory.push_back({stamp, rigid_motion(fmt::format("{}.poses[{}]", name, i), matrix)});
  }
  return trajectory;
}

}  // namespace dkp_slam::python
