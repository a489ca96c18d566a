# Installs the build into a folder of its own and uses it from there, as others do: the program with
# its own cameras and libraries, examples/minimal by find_package, and the same by pkg-config.
#   cmake -DSOURCE=... -DBUILD=... -DWORK=... -DCOMPILER=... -DFLAGS=... -DPKG_CONFIG=... -P this
set(stage ${WORK}/stage)
set(sequence ${WORK}/sequence)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
# What is set for the tests must not help.
set(ENV{LD_LIBRARY_PATH})

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  set(out "${out}" PARENT_SCOPE)
  set(err "${err}" PARENT_SCOPE)
  if(what STREQUAL "must fail")
    if(code EQUAL 0)
      message(FATAL_ERROR "did not fail: ${ARGN}\n${out}${err}")
    endif()
  elseif(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}): ${ARGN}\n${out}${err}")
  endif()
endfunction()

function(expect_path poses)
  string(REGEX MATCHALL "[^\n]+" lines "${poses}")
  list(LENGTH lines count)
  if(count LESS 20)
    message(FATAL_ERROR "of 24 frames ${count} were localised:\n${poses}")
  endif()
endfunction()

run("the installation" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${stage})
run("the installed program" ${stage}/bin/dkp-slam synth walking_xyz --frames 24 --out ${sequence})

# Its shared libraries are those beside it, where it brought any.
file(GLOB_RECURSE brought ${stage}/lib*/libonnxruntime.so.1)
file(GLOB_RECURSE libraries ${stage}/lib*/libdkp_slam.so)
if(brought)
  foreach(file ${stage}/bin/dkp-slam ${libraries})
    run("ldd" ldd ${file})
    if(NOT out MATCHES "libonnxruntime.so.1 => ${stage}")
      message(FATAL_ERROR "${file} does not find the ONNX Runtime that is installed:\n${out}")
    endif()
  endforeach()
endif()

# By find_package.
run("configuring the example" ${CMAKE_COMMAND} -S ${SOURCE}/examples/minimal -B ${WORK}/minimal
    -DCMAKE_PREFIX_PATH=${stage} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})
run("building the example" ${CMAKE_COMMAND} --build ${WORK}/minimal)
run("the example" ${WORK}/minimal/minimal ${sequence} ${sequence}/camera.yaml)
expect_path("${out}")
run("must fail" ${WORK}/minimal/minimal ${sequence} ${WORK}/nowhere.yaml)
if(NOT err MATCHES "nowhere.yaml")
  message(FATAL_ERROR "the example's error does not name the file:\n${err}")
endif()

# By pkg-config.
file(GLOB_RECURSE description ${stage}/lib*/dkp_slam.pc)
get_filename_component(folder ${description} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${folder})
run("pkg-config" ${PKG_CONFIG} --cflags --libs dkp_slam)
separate_arguments(options UNIX_COMMAND "${FLAGS} ${out}")
run("building by pkg-config" ${COMPILER} -std=c++20 ${SOURCE}/examples/minimal/main.cpp
    -o ${WORK}/by_pkg_config ${options})

# Its cameras are the installed ones: one of them, spoilt, is what it complains of.
file(APPEND ${stage}/share/dkp-slam/config/tum_fr1.yaml "\nspoilt: 1\n")
run("must fail" ${stage}/bin/dkp-slam run ${sequence} --camera fr1 --out ${WORK}/out)
if(NOT err MATCHES "share/dkp-slam/config/tum_fr1.yaml.*spoilt")
  message(FATAL_ERROR "the program does not read the installed cameras:\n${err}")
endif()

# Headers that need what users need not have are refused.
file(WRITE ${WORK}/bad/dkp_slam/bad.h "#pragma once\n#include <opencv2/highgui.hpp>\n")
run("must fail" ${CMAKE_COMMAND} -DDKP_SLAM_PUBLIC_HEADERS=dkp_slam/bad.h
    -DDKP_SLAM_HEADER_ROOT=${WORK}/bad -DCMAKE_INSTALL_PREFIX=${WORK}/bad_stage
    -P ${BUILD}/generated/install_headers.cmake)
if(NOT err MATCHES "bad.h would be installed, but[ \n]+includes[ \n]+<opencv2/highgui.hpp>")
  message(FATAL_ERROR "not refused for its reason:\n${err}")
endif()

# So is a model that is put there: this one is none, which is said of it by name.
unset(ENV{DKP_SLAM_MODEL})
file(WRITE ${stage}/share/dkp-slam/models/yolox_nano.onnx "no model")
run("must fail" ${stage}/bin/dkp-slam run ${sequence} --detector yolox --out ${WORK}/out)
if(NOT err MATCHES "share/dkp-slam/models/yolox_nano.onnx")
  message(FATAL_ERROR "the program does not find the installed model:\n${err}")
endif()
