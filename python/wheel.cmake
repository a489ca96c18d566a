# A wheel: the package with libdkp_slam and its ONNX Runtime beside it, packed by python3-wheel. What
# those need of Debian (OpenCV, ...) is Debian's. `cmake --build build/release --target wheel`.
execute_process(
  COMMAND ${Python_EXECUTABLE} -c "import wheel, sysconfig; print(sysconfig.get_platform().replace('-', '_'))"
  OUTPUT_VARIABLE platform OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE missing)
if(missing)
  message(STATUS "Wheel: left out, for want of python3-wheel (scripts/setup.sh --with python)")
  return()
endif()
set(python_tag cp${Python_VERSION_MAJOR}${Python_VERSION_MINOR})
set(WHEEL_TAG ${python_tag}-${python_tag}-${platform})
set(wheel_file ${CMAKE_BINARY_DIR}/dkp_slam-${PROJECT_VERSION}-${WHEEL_TAG}.whl)
foreach(file METADATA WHEEL)
  configure_file(wheel/${file}.in ${CMAKE_BINARY_DIR}/generated/wheel/${file} @ONLY)
endforeach()

set(in_wheel COMPONENT wheel EXCLUDE_FROM_ALL)
install_package(dkp_slam ${in_wheel})
install(TARGETS dkp_slam LIBRARY DESTINATION dkp_slam NAMELINK_SKIP ${in_wheel})
if(OnnxRuntime_FOUND AND NOT OnnxRuntime_LIBRARY MATCHES "^/(usr/)?lib/")
  get_filename_component(folder ${OnnxRuntime_LIBRARY} DIRECTORY)
  install(FILES ${folder}/libonnxruntime.so.1 DESTINATION dkp_slam/dkp-slam ${in_wheel})
endif()
set(about dkp_slam-${PROJECT_VERSION}.dist-info)
install(FILES ${CMAKE_BINARY_DIR}/generated/wheel/METADATA ${CMAKE_BINARY_DIR}/generated/wheel/WHEEL
              ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${about} ${in_wheel})

configure_file(wheel/pack.cmake.in ${CMAKE_BINARY_DIR}/generated/wheel/pack.cmake.in @ONLY)
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/generated/wheel/pack.cmake
     INPUT ${CMAKE_BINARY_DIR}/generated/wheel/pack.cmake.in)
add_custom_target(wheel
  COMMAND ${CMAKE_COMMAND} -P ${CMAKE_BINARY_DIR}/generated/wheel/pack.cmake
  BYPRODUCTS ${wheel_file}
  DEPENDS _core _synth dkp_slam
  COMMENT "Packing ${wheel_file}")
