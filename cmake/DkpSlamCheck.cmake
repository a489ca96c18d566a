# What clang-tidy looks at as one piece (scripts/check.sh, preset check). Most of its time goes into
# the headers of Eigen and OpenCV, once for each piece: so folders that use the same ones go together.
# A folder that is named in no piece is one, with all below it.
set(pieces "base config" "dense export" "feature geometry localization" "map map_file mapping" "loop optimization tracking")

get_property(libraries GLOBAL PROPERTY DKP_SLAM_LIBRARIES)
foreach(library ${libraries})
  get_target_property(folder ${library} SOURCE_DIR)
  get_target_property(sources ${library} SOURCES)
  list(TRANSFORM sources PREPEND ${folder}/)
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR}/dkp_slam ${folder})
  string(REGEX REPLACE "/.*" "" folder "${folder}")
  if(NOT folder)
    set(folder base)
  endif()
  set(name ${folder})
  foreach(piece ${pieces})
    if(" ${piece} " MATCHES " ${folder} ")
      string(REPLACE " " "_" name ${piece})
    endif()
  endforeach()
  if(NOT TARGET check_${name})
    # Never built: only its compile commands are asked for.
    add_library(check_${name} OBJECT EXCLUDE_FROM_ALL)
    set_target_properties(check_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
    # Found at once, without a look into each of the folders of links.
    target_include_directories(check_${name} BEFORE PRIVATE ${CMAKE_SOURCE_DIR})
  endif()
  target_sources(check_${name} PRIVATE ${sources})
  target_link_libraries(check_${name} PRIVATE ${library})
  # Outside libraries that only the sources need are not passed on.
  foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS)
    set_property(TARGET check_${name} APPEND PROPERTY ${property} $<TARGET_PROPERTY:${library},${property}>)
  endforeach()
endforeach()
