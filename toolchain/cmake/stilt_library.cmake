# Functions that reduce every CMakeLists.txt to a list of files.

# stilt_library(NAME SOURCES ... LIBRARIES ...): a static library with the project's flags.
function(stilt_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC stilt_flags ${ARG_LIBRARIES})
endfunction()

# stilt_program(NAME SOURCES ... LIBRARIES ...): an executable in build/.../bin.
function(stilt_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE stilt_flags ${ARG_LIBRARIES})
endfunction()

# stilt_test(NAME SOURCES ... LIBRARIES ... [LABELS ...]): a GoogleTest program; ctest lists each of its tests.
function(stilt_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE stilt_flags ${ARG_LIBRARIES} GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  set(longest_s 900)
  if(STILT_SANITIZE)
    set(longest_s 7200)  # two tests of experiments need more than 900 s
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    PROPERTIES TIMEOUT ${longest_s} LABELS "${ARG_LABELS}")
endfunction()
