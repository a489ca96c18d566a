#pragma once

#include <string_view>
#include <vector>

namespace dkp_slam::viewer {

/// A file of the page, as it was built (scripts/build_page.sh) and lies in the program.
struct PageFile {
  const char* path;  ///< as it is asked for
  const char* type;
  std::string_view content;
};

const std::vector<PageFile>& page_files();

}  // namespace dkp_slam::viewer
