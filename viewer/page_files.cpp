#include "viewer/page_files.h"

// The assembler takes the files in as they are, which no compiler does as fast.
#define EMBED(name, file)                        \
  __asm__(                                       \
      ".section .rodata\n"                       \
      ".global dkp_slam_page_" #name             \
      "\n"                                       \
      ".global dkp_slam_page_" #name             \
      "_end\n"                                   \
      "dkp_slam_page_" #name                     \
      ":\n"                                      \
      ".incbin \"" DKP_SLAM_PAGE_FOLDER "/" file \
      "\"\n"                                     \
      "dkp_slam_page_" #name                     \
      "_end:\n"                                  \
      ".byte 0\n"                                \
      ".previous\n");                            \
  extern "C" const char dkp_slam_page_##name[], dkp_slam_page_##name##_end[]

EMBED(html, "index.html");
EMBED(script, "page.js");
EMBED(worker, "ticks.js");
EMBED(style, "page.css");
EMBED(icon, "icon.svg");
EMBED(licences, "licences.txt");

namespace dkp_slam::viewer {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

const std::vector<PageFile>& page_files() {
  static const std::vector<PageFile> files{
      {"/", "text/html; charset=utf-8", between(dkp_slam_page_html, dkp_slam_page_html_end)},
      {"/page.js", "text/javascript", between(dkp_slam_page_script, dkp_slam_page_script_end)},
      {"/ticks.js", "text/javascript", between(dkp_slam_page_worker, dkp_slam_page_worker_end)},
      {"/page.css", "text/css", between(dkp_slam_page_style, dkp_slam_page_style_end)},
      {"/licences.txt", "text/plain; charset=utf-8",
       between(dkp_slam_page_licences, dkp_slam_page_licences_end)},
      {"/icon.svg", "image/svg+xml", between(dkp_slam_page_icon, dkp_slam_page_icon_end)}};
  return files;
}

}  // namespace dkp_slam::viewer
