#include "viewer/page_files.h"

#include "dkp_slam/embedded_file.h"

DKP_SLAM_EMBED_FILE(page_html, DKP_SLAM_PAGE_FOLDER "/index.html");
DKP_SLAM_EMBED_FILE(page_script, DKP_SLAM_PAGE_FOLDER "/page.js");
DKP_SLAM_EMBED_FILE(page_worker, DKP_SLAM_PAGE_FOLDER "/ticks.js");
DKP_SLAM_EMBED_FILE(page_style, DKP_SLAM_PAGE_FOLDER "/page.css");
DKP_SLAM_EMBED_FILE(page_icon, DKP_SLAM_PAGE_FOLDER "/icon.svg");
DKP_SLAM_EMBED_FILE(page_licences, DKP_SLAM_PAGE_FOLDER "/licences.txt");

namespace dkp_slam::viewer {

const std::vector<PageFile>& page_files() {
  static const std::vector<PageFile> files{
      {"/", "text/html; charset=utf-8", DKP_SLAM_EMBEDDED(page_html)},
      {"/page.js", "text/javascript", DKP_SLAM_EMBEDDED(page_script)},
      {"/ticks.js", "text/javascript", DKP_SLAM_EMBEDDED(page_worker)},
      {"/page.css", "text/css", DKP_SLAM_EMBEDDED(page_style)},
      {"/licences.txt", "text/plain; charset=utf-8", DKP_SLAM_EMBEDDED(page_licences)},
      {"/icon.svg", "image/svg+xml", DKP_SLAM_EMBEDDED(page_icon)}};
  return files;
}

}  // namespace dkp_slam::viewer
