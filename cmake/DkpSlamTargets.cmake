# How the folders of dkp_slam/ become CMake targets.
#
# Every folder is a library of its own. Its headers reach other targets through a folder of links,
# build/views/NAME, that holds no others: whoever does not link a library cannot include its
# headers, so that an include against the order of docs/architecture.md does not build.

# dkp_slam_library(NAME [SOURCES file...] [USES folder-target...] [LINK library...] [PRIVATE library...])
#   NAME     of the folder under dkp_slam/, "/" as "_": target dkp_slam_NAME
#   USES     other folders whose headers this one may include
#   LINK     outside libraries that its headers need; PRIVATE, that only its sources need
function(dkp_slam_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;USES;LINK;PRIVATE")
  set(view ${CMAKE_BINARY_DIR}/views/${name})
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  file(REMOVE_RECURSE ${view})
  file(MAKE_DIRECTORY ${view}/${folder})
  foreach(header ${headers})
    get_filename_component(file ${header} NAME)
    file(CREATE_LINK ${header} ${view}/${folder}/${file} SYMBOLIC)
  endforeach()

  set(target dkp_slam_${name})
  list(TRANSFORM arg_USES PREPEND dkp_slam_)
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_include_directories(${target} PUBLIC ${view})
    target_link_libraries(${target} PUBLIC ${arg_USES} ${arg_LINK} PRIVATE ${arg_PRIVATE})
    set_property(GLOBAL APPEND PROPERTY DKP_SLAM_LIBRARIES ${target})
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${view})
    target_link_libraries(${target} INTERFACE ${arg_USES} ${arg_LINK})
  endif()
endfunction()

# Tests: what takes most of the compiler's time, other people's headers, is read once for all of them
# (not in preset debug, which shows what a source forgot to include), and what they do themselves is
# not worth being optimised more than a little.
if(DKP_SLAM_TESTS)
  set(dkp_slam_test_options $<$<CONFIG:Release>:-O1>)
  if(CCACHE_PROGRAM AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    list(APPEND dkp_slam_test_options -fpch-preprocess)
  endif()
  # Every test program takes the whole core: gold links one in a third of the time.
  set(dkp_slam_test_link_options "")
  find_program(DKP_SLAM_GOLD ld.gold)
  if(DKP_SLAM_GOLD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND NOT DKP_SLAM_SANITIZE)
    set(dkp_slam_test_link_options -fuse-ld=gold)
  endif()
  add_library(dkp_slam_test_headers OBJECT ${CMAKE_SOURCE_DIR}/tests/support/headers.cpp)
  target_compile_options(dkp_slam_test_headers PRIVATE ${dkp_slam_test_options})
  target_link_libraries(dkp_slam_test_headers PRIVATE Eigen3::Eigen opencv_core opencv_imgproc fmt::fmt GTest::gtest)
  target_precompile_headers(dkp_slam_test_headers PRIVATE
    <algorithm> <chrono> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory> <optional> <random> <string>
    <thread> <vector> <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <gmock/gmock.h> <gtest/gtest.h>
    <opencv2/core.hpp> <opencv2/imgproc.hpp>)
endif()

# dkp_slam_test(NAME [AT_ONCE] [RECORDINGS] [COST seconds] source...): one test program per folder,
# its cases known to ctest one by one, or all AT_ONCE where they share what takes long to make. With
# RECORDINGS they may play rendered sequences (tests/support/recording.h). COST: about how long one
# of them takes where that is seconds; ctest begins with the longest, so that no core waits for them
# at the end. Tests may include anything.
function(dkp_slam_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "AT_ONCE;RECORDINGS" "COST" "")
  if(NOT arg_COST)
    set(arg_COST 0)
  endif()
  if(NOT DKP_SLAM_TESTS)
    return()
  endif()
  add_executable(${name} ${arg_UNPARSED_ARGUMENTS})
  target_compile_options(${name} PRIVATE ${dkp_slam_test_options})
  target_link_options(${name} PRIVATE ${dkp_slam_test_link_options})
  target_precompile_headers(${name} REUSE_FROM dkp_slam_test_headers)
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE dkp_slam_everything dkp_slam_export_images GTest::gtest GTest::gmock_main
                        opencv_calib3d opencv_video nlohmann_json::nlohmann_json
                        spdlog::spdlog)
  if(arg_RECORDINGS)
    target_link_libraries(${name} PRIVATE dkp_slam_recordings)
    add_dependencies(${name} dkp_slam_recording)
  endif()
  if(arg_AT_ONCE)
    add_test(NAME ${name} COMMAND ${name})
    math(EXPR timeout "3 * ${dkp_slam_test_timeout}")
    set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout} COST ${arg_COST})
  else()
    gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
      PROPERTIES TIMEOUT ${dkp_slam_test_timeout} COST ${arg_COST})
  endif()
endfunction()
