// rgb.txt, depth.txt and associations.txt.
#include <cmath>

#include "dkp_slam/sensor/tum_lists.h"
#include "fuzz/target.h"

namespace dkp_slam::fuzz {
namespace {

template <class Line>
std::vector<double> stamps_of(const std::vector<Line>& lines) {
  std::vector<double> stamps;
  for (const Line& line : lines) {
    require(std::isfinite(line.timestamp), "a time stamp that is no number");
    require(stamps.empty() || line.timestamp > stamps.back(), "time stamps that do not rise");
    stamps.push_back(line.timestamp);
  }
  return stamps;
}

void run(Bytes bytes) {
  const InputFile file(bytes);
  takes([&] {
    for (const ImagePair& pair : read_associations(file.path())) {
      require(!pair.colour.empty() && !pair.depth.empty(), "a pair without a name");
    }
    stamps_of(read_associations(file.path()));
  });
  takes([&] {
    const std::vector<double> a = stamps_of(read_stamped_files(file.path()));
    std::vector<double> b = a;
    for (double& stamp : b) stamp += 0.01;
    constexpr double most = 0.02;
    std::vector<bool> used(b.size());
    std::size_t next = 0;
    for (const auto& [i, j] : associate(a, b, most)) {
      require(i >= next && i < a.size() && j < b.size(), "pairs out of order");
      require(!used[j], "an image in two pairs");
      require(std::abs(a[i] - b[j]) < most, "a pair too far apart");
      used[j] = true;
      next = i + 1;
    }
  });
}

std::vector<std::string> seeds() {
  return {"# timestamp filename\n1.5 rgb/1.5.png\n1.533 rgb/1.533.png\n",
          "1.0 rgb/1.png 1.01 depth/1.png\n2.0,depth/2.png\t2.01 rgb/2.png\n",
          "1e3 a\r\n-1 b\n0x10 c\n"};
}

const Registration registration({"lists", run, seeds});

}  // namespace
}  // namespace dkp_slam::fuzz
