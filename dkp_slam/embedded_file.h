#pragma once

#include <string_view>

/// Takes a file into the program as it is, by the assembler, which no compiler does as fast, under
/// a name that no other file has. At namespace scope of a source; `file` is a literal path, and the
/// build must know that the source depends on it (OBJECT_DEPENDS).
#define DKP_SLAM_EMBED_FILE(name, file) \
  __asm__(                              \
      ".section .rodata\n"              \
      ".global dkp_slam_file_" #name    \
      "\n"                              \
      ".global dkp_slam_file_" #name    \
      "_end\n"                          \
      "dkp_slam_file_" #name            \
      ":\n"                             \
      ".incbin \"" file                 \
      "\"\n"                            \
      "dkp_slam_file_" #name            \
      "_end:\n"                         \
      ".byte 0\n"                       \
      ".previous\n");                   \
  extern "C" const char dkp_slam_file_##name[], dkp_slam_file_##name##_end[]

/// What such a file holds.
#define DKP_SLAM_EMBEDDED(name)          \
  std::string_view(dkp_slam_file_##name, \
                   static_cast<std::size_t>(dkp_slam_file_##name##_end - dkp_slam_file_##name))
