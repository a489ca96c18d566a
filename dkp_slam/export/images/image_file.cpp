#include "dkp_slam/export/images/image_file.h"

#include <cstdint>
#include <fstream>
#include <vector>

#include "dkp_slam/error.h"
#include "dkp_slam/sensor/png_encoder.h"

namespace dkp_slam {

void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(path.string() + ": cannot write; is the disk full?");
}

}  // namespace dkp_slam
