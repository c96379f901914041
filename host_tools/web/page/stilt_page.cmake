# What the pages share: drawing of the robot, colours, parts of plots, and how a page becomes one string in a
# program, so that it loads nothing from elsewhere.
set(page_dir ${CMAKE_CURRENT_LIST_DIR})
set(uplot_dir ${PROJECT_SOURCE_DIR}/host_tools/web/page/node_modules/uplot)

# stilt_page(OUTPUT NAME.cc PAGE page.html STYLES ... SCRIPTS ... VARIABLE stilt::x::kName HEADER x.h): scripts share
# one scope and are listed in order of use; names without a folder are those of host_tools/web/page.
function(stilt_page)
  cmake_parse_arguments(ARG "" "OUTPUT;PAGE;VARIABLE;HEADER" "STYLES;SCRIPTS" ${ARGN})
  foreach(list STYLES SCRIPTS)
    set(${list} "")
    foreach(file IN LISTS ARG_${list})
      if(file MATCHES "/")
        list(APPEND ${list} ${CMAKE_CURRENT_SOURCE_DIR}/${file})
      else()
        list(APPEND ${list} ${page_dir}/${file})
      endif()
    endforeach()
  endforeach()
  set(dependencies ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_PAGE} ${STYLES} ${SCRIPTS} ${page_dir}/embed_page.cmake)
  if(EXISTS ${uplot_dir})
    list(APPEND dependencies
      ${uplot_dir}/dist/uPlot.iife.min.js ${uplot_dir}/dist/uPlot.min.css ${uplot_dir}/LICENSE)
  else()
    message(WARNING "${CMAKE_CURRENT_SOURCE_DIR}: the plot library is missing, so the page cannot be built. "
      "Run toolchain/setup, or: npm ci --prefix host_tools/web/page")
  endif()
  add_custom_command(
    OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${ARG_OUTPUT}
    COMMAND ${CMAKE_COMMAND}
      "-DPAGE=${CMAKE_CURRENT_SOURCE_DIR}/${ARG_PAGE}" "-DUPLOT_DIR=${uplot_dir}"
      "-DSTYLES=${STYLES}" "-DSCRIPTS=${SCRIPTS}" "-DVARIABLE=${ARG_VARIABLE}" "-DHEADER=${ARG_HEADER}"
      "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${ARG_OUTPUT}"
      -P ${page_dir}/embed_page.cmake
    DEPENDS ${dependencies}
    COMMENT "Assembling ${ARG_PAGE}"
    VERBATIM)
endfunction()
