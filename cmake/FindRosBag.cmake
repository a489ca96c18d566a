# Debian 12's rosbag, which reads and writes ROS 1 bags: target RosBag::RosBag. Its own CMake and
# pkg-config files name packages that Debian does not have under these names. With bzip2, by which it
# packs and which its headers include.
find_path(RosBag_INCLUDE_DIR rosbag/view.h)
find_path(RosBag_MESSAGES_INCLUDE_DIR sensor_msgs/CompressedImage.h)
set(RosBag_libraries rosbag_storage roscpp_serialization rostime cpp_common console_bridge bz2)
set(RosBag_found_libraries "")
foreach(name ${RosBag_libraries})
  find_library(RosBag_${name}_LIBRARY ${name})
  mark_as_advanced(RosBag_${name}_LIBRARY)
  list(APPEND RosBag_found_libraries RosBag_${name}_LIBRARY)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RosBag REQUIRED_VARS RosBag_INCLUDE_DIR
                                  RosBag_MESSAGES_INCLUDE_DIR ${RosBag_found_libraries})

if(RosBag_FOUND AND NOT TARGET RosBag::RosBag)
  add_library(RosBag::RosBag INTERFACE IMPORTED GLOBAL)
  # rosbag/bag.h includes pluginlib, whose headers lie in folders of ROS 2.
  set(folders ${RosBag_INCLUDE_DIR} ${RosBag_MESSAGES_INCLUDE_DIR})
  foreach(package pluginlib class_loader rcpputils rcutils ament_index_cpp)
    if(IS_DIRECTORY ${RosBag_INCLUDE_DIR}/${package}/${package})
      list(APPEND folders ${RosBag_INCLUDE_DIR}/${package})
    endif()
  endforeach()
  target_include_directories(RosBag::RosBag INTERFACE ${folders})
  foreach(name ${RosBag_found_libraries})
    target_link_libraries(RosBag::RosBag INTERFACE ${${name}})
  endforeach()
endif()
