# Writes OUTPUT, a C++ source that defines a page as one string, VARIABLE (stilt::x::kName) as declared in HEADER.
# That is PAGE, where the PARTS of all pages, the lists STYLES and SCRIPTS and the plot library in UPLOT_DIR replace its
# marks.

if(NOT EXISTS ${UPLOT_DIR}/dist/uPlot.iife.min.js)
  message(FATAL_ERROR "The plot library is missing at ${UPLOT_DIR}. "
    "Run toolchain/setup, or: npm ci --prefix host_tools/web/page")
endif()

# Texts of the files, one after the other.
function(join_files output)
  set(joined "")
  foreach(file IN LISTS ARGN)
    file(READ ${file} text)
    string(APPEND joined "${text}\n")
  endforeach()
  set(${output} "${joined}" PARENT_SCOPE)
endfunction()

file(READ ${PAGE} page)
foreach(part IN LISTS PARTS)
  get_filename_component(mark ${part} NAME_WE)
  file(READ ${part} text)
  string(REPLACE "{{${mark}}}\n" "${text}" page "${page}")
endforeach()
join_files(style ${STYLES})
join_files(script ${SCRIPTS})
file(READ ${UPLOT_DIR}/dist/uPlot.iife.min.js uplot_script)
file(READ ${UPLOT_DIR}/dist/uPlot.min.css uplot_style)
file(READ ${UPLOT_DIR}/LICENSE uplot_license)
foreach(mark uplot_license uplot_style uplot_script style script)
  string(REPLACE "{{${mark}}}" "${${mark}}" page "${page}")
endforeach()

string(REGEX MATCH "^(.*)::([^:]*)$" unused ${VARIABLE})
file(WRITE ${OUTPUT}.new "// Assembled by host_tools/web/page/embed_page.cmake.
#include \"${HEADER}\"

namespace ${CMAKE_MATCH_1} {
const std::string_view ${CMAKE_MATCH_2} = R\"STILT_PAGE(${page})STILT_PAGE\";
}  // namespace ${CMAKE_MATCH_1}
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
