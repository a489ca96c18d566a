# The core as others take it: one shared library, its headers, a CMake package, a pkg-config file,
# a Debian package. Included after the core's folders and before those beside it.

# Every static library of the core so far. Their objects, so that nothing is left out; Ceres, which
# is static, is linked here once and belongs to nobody else's link line.
get_property(core GLOBAL PROPERTY DKP_SLAM_LIBRARIES)
list(FILTER core EXCLUDE REGEX "^dkp_slam_(evaluation|export_images|synth|dense_octomap|sensor_bag|sensor_kinect|sensor_layout)")
set(objects ${core})
list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
add_library(dkp_slam SHARED ${objects})
add_library(dkp_slam::dkp_slam ALIAS dkp_slam)
set_target_properties(dkp_slam PROPERTIES
  LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}
  INSTALL_RPATH "$ORIGIN/dkp-slam")
target_compile_features(dkp_slam PUBLIC cxx_std_20)
target_include_directories(dkp_slam INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(dkp_slam PUBLIC Eigen3::Eigen opencv_core PRIVATE ${core})
# Ceres stays inside, unseen: a user may have another.
target_link_options(dkp_slam PRIVATE -Wl,--as-needed -Wl,--exclude-libs,ALL)
if(NOT DKP_SLAM_SANITIZE)
  target_link_options(dkp_slam PRIVATE -Wl,--no-undefined)
endif()

set(documents ${CMAKE_INSTALL_DATAROOTDIR}/doc/dkp-slam)
# ONNX Runtime comes along where it is not the system's own.
set(private_library_folder ${CMAKE_INSTALL_LIBDIR}/dkp-slam)
if(OnnxRuntime_FOUND AND NOT OnnxRuntime_LIBRARY MATCHES "^/(usr/)?lib/")
  get_filename_component(folder ${OnnxRuntime_LIBRARY} DIRECTORY)
  install(FILES ${folder}/libonnxruntime.so.1 DESTINATION ${private_library_folder}
          PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  foreach(text LICENSE ThirdPartyNotices.txt)
    install(FILES ${folder}/../${text} DESTINATION ${documents}/onnxruntime OPTIONAL)
  endforeach()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${folder})
endif()

install(TARGETS dkp_slam EXPORT dkp_slam LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT dkp_slam NAMESPACE dkp_slam:: FILE dkp_slamTargets.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dkp_slam)
include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/dkp_slamConfig.cmake.in generated/dkp_slamConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dkp_slam)
write_basic_package_version_file(generated/dkp_slamConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/dkp_slamConfig.cmake
              ${CMAKE_BINARY_DIR}/generated/dkp_slamConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/dkp_slam)
file(RELATIVE_PATH PREFIX_FROM_PC /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" PREFIX_FROM_PC "${PREFIX_FROM_PC}")
configure_file(cmake/dkp_slam.pc.in generated/dkp_slam.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/generated/dkp_slam.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# The public headers and what they include, nothing else; looked up when it is installed.
set(DKP_SLAM_PUBLIC_HEADERS
  dkp_slam/detection/factory/detector_factory.h
  dkp_slam/detection/recorded_detector.h
  dkp_slam/error.h
  dkp_slam/export/trajectory.h
  dkp_slam/map_file/map_file.h
  dkp_slam/sensor/camera_config.h
  dkp_slam/sensor/tum_source.h
  dkp_slam/system/slam.h
  dkp_slam/version.h)
configure_file(cmake/install_headers.cmake.in generated/install_headers.cmake @ONLY)
install(SCRIPT ${CMAKE_BINARY_DIR}/generated/install_headers.cmake)

install(DIRECTORY config DESTINATION ${CMAKE_INSTALL_DATADIR}/dkp-slam)
install(DIRECTORY DESTINATION ${CMAKE_INSTALL_DATADIR}/dkp-slam/models)
install(PROGRAMS scripts/fetch_model.sh DESTINATION ${CMAKE_INSTALL_BINDIR}
        RENAME dkp-slam-fetch-model)
install(FILES LICENSE DESTINATION ${documents} RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME dkp-slam)
set(CPACK_PACKAGE_VENDOR "the dkp-slam project")
set(CPACK_PACKAGE_CONTACT "the dkp-slam project <dkp-slam@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Below its first line, which is the project's.
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Finds the path of an RGB-D camera and keeps a map of what stands still, on a
CPU: people are found by a detector, cut out by their depth, and left out of
the map. The program dkp-slam, the library libdkp_slam and its headers.
Licence: Apache-2.0; ONNX Runtime, which comes along, MIT.")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What others get libdkp_slam from; not ONNX Runtime, which is for our own use.
file(WRITE ${CMAKE_BINARY_DIR}/generated/shlibs
     "libdkp_slam ${PROJECT_VERSION_MAJOR} dkp-slam (= ${PROJECT_VERSION})\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/generated/shlibs)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "curl, ca-certificates")
# For programs that are built against the library, and for the Python module.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, libeigen3-dev, libopencv-dev, python3-numpy")
include(CPack)
