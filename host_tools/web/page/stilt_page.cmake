# A page becomes one string in a program, so that it loads nothing from elsewhere. It holds the page's own body, styles
# and scripts, and what this folder holds for all pages.
set(page_dir ${CMAKE_CURRENT_LIST_DIR})
set(uplot_dir ${page_dir}/node_modules/uplot)
set(page_parts head.html stage.html scripts.html)
# In order of use: all scripts share one scope.
set(page_scripts elements.js theme.js table.js kinematics.js canvas_shapes.js scene.js robot_data.js svg_context.js
  export.js stage.js plot_parts.js plot.js plot_group.js viewer.js)

# stilt_page(OUTPUT NAME.cc PAGE page.html STYLES ... SCRIPTS ... VARIABLE stilt::x::kName HEADER x.h)
function(stilt_page)
  cmake_parse_arguments(ARG "" "OUTPUT;PAGE;VARIABLE;HEADER" "STYLES;SCRIPTS" ${ARGN})
  list(TRANSFORM page_parts PREPEND ${page_dir}/ OUTPUT_VARIABLE parts)
  list(TRANSFORM page_scripts PREPEND ${page_dir}/ OUTPUT_VARIABLE scripts)
  set(styles ${page_dir}/page.css ${ARG_STYLES})
  list(APPEND scripts ${ARG_SCRIPTS})
  set(dependencies ${ARG_PAGE} ${parts} ${styles} ${scripts} ${page_dir}/embed_page.cmake)
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
      "-DPAGE=${ARG_PAGE}" "-DPARTS=${parts}" "-DUPLOT_DIR=${uplot_dir}"
      "-DSTYLES=${styles}" "-DSCRIPTS=${scripts}" "-DVARIABLE=${ARG_VARIABLE}" "-DHEADER=${ARG_HEADER}"
      "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${ARG_OUTPUT}"
      -P ${page_dir}/embed_page.cmake
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    DEPENDS ${dependencies}
    COMMENT "Assembling ${ARG_PAGE}"
    VERBATIM)
endfunction()
