# The library for loops of others' own (docs/library.md, docs/decisions/0034-library.md): libstilt.a, and
# libstilt_simulation.a with the simulated robot.
if(STILT_SANITIZE OR STILT_FUZZ OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  return()
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(library_folder ${PROJECT_BINARY_DIR}/library)
set(library_destination lib/${CMAKE_LIBRARY_ARCHITECTURE})  # where Debian has libraries of one architecture
file(MAKE_DIRECTORY ${library_folder})

# stilt_installed_library(NAME ENTRY target CLASSES mangled... LIBRARIES ...): an archive of one object, all that the
# entry needs. Only the classes stay visible: inline functions of Eigen and the standard library, compiled for AVX2,
# must not replace those of the user's program.
function(stilt_installed_library name)
  cmake_parse_arguments(ARG "" "ENTRY" "CLASSES;LIBRARIES" ${ARGN})
  set(object ${library_folder}/${name}.o)
  set(archive ${library_folder}/lib${name}.a)
  foreach(library ${ARG_LIBRARIES})
    list(APPEND files $<TARGET_FILE:${library}>)
  endforeach()
  foreach(class ${ARG_CLASSES})
    list(APPEND visible --keep-global-symbol=_ZN5stilt${class}* --keep-global-symbol=_ZNK5stilt${class}*)
  endforeach()
  add_custom_command(OUTPUT ${archive}
    COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${object}.all
      --whole-archive $<TARGET_FILE:${ARG_ENTRY}> --no-whole-archive --start-group ${files} --end-group
    # Constants of headers are unique symbols; objcopy makes only global and weak ones local.
    COMMAND ${CMAKE_OBJCOPY} --wildcard --weaken-symbol=_ZN5stilt* --weaken-symbol=_ZNSt*
      --weaken-symbol=_ZZ* ${object}.all
    COMMAND ${CMAKE_OBJCOPY} --wildcard ${visible} --strip-unneeded --remove-section=.comment
      ${object}.all ${object}
    COMMAND ${CMAKE_COMMAND} -E rm -f ${object}.all ${archive}
    COMMAND ${CMAKE_AR} rcsD ${archive} ${object}
    DEPENDS ${ARG_ENTRY} ${ARG_LIBRARIES}
    COMMENT "Joining lib${name}.a"
    VERBATIM)
  add_custom_target(${name}_archive DEPENDS ${archive})
  add_dependencies(stilt_library ${name}_archive)
  install(FILES ${archive} DESTINATION ${library_destination} COMPONENT library EXCLUDE_FROM_ALL)
endfunction()

add_custom_target(stilt_library ALL)
set(controller_libraries
  stilt_configured_controller stilt_control_loop stilt_configuration stilt_peers stilt_gait_files stilt_dispatch
  stilt_control stilt_sqp stilt_ocp stilt_gait stilt_lq stilt_model stilt_supervisor stilt_robots stilt_files stilt_urdf stilt_hal
  stilt_hal_sensors stilt_hal_drivers stilt_hal_bus stilt_hal_frames stilt_hal_load stilt_hal_serial)
stilt_installed_library(stilt ENTRY stilt_library_controller CLASSES 10Controller LIBRARIES ${controller_libraries})
stilt_installed_library(stilt_simulation ENTRY stilt_library_simulation CLASSES 14SimulatedRobot
  LIBRARIES stilt_library_controller stilt_closed_loop stilt_plant stilt_mjcf ${controller_libraries})

configure_file(${CMAKE_CURRENT_LIST_DIR}/stilt.pc.in ${library_folder}/stilt.pc @ONLY)
configure_file(${CMAKE_CURRENT_LIST_DIR}/stilt-simulation.pc.in ${library_folder}/stilt-simulation.pc @ONLY)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/stiltConfig.cmake.in ${library_folder}/stiltConfig.cmake
  INSTALL_DESTINATION ${library_destination}/cmake/stilt PATH_VARS CMAKE_INSTALL_INCLUDEDIR library_destination
  NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${library_folder}/stiltConfigVersion.cmake COMPATIBILITY SameMinorVersion)

set(in_library COMPONENT library EXCLUDE_FROM_ALL)
install(FILES
  ${PROJECT_SOURCE_DIR}/firmware/library/stilt/types.h ${PROJECT_SOURCE_DIR}/firmware/library/stilt/controller.h
  ${PROJECT_SOURCE_DIR}/host_tools/library/stilt/simulated_robot.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stilt ${in_library})
install(FILES ${library_folder}/stilt.pc ${library_folder}/stilt-simulation.pc
  DESTINATION ${library_destination}/pkgconfig ${in_library})
install(FILES ${library_folder}/stiltConfig.cmake ${library_folder}/stiltConfigVersion.cmake
  DESTINATION ${library_destination}/cmake/stilt ${in_library})
install(FILES ${PROJECT_SOURCE_DIR}/docs/examples/own_loop/walk.cc
  ${PROJECT_SOURCE_DIR}/docs/examples/own_loop/CMakeLists.txt
  DESTINATION share/doc/libstilt-dev/examples/own_loop ${in_library})
