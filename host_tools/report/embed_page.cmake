# Writes OUTPUT, a C++ source that defines stilt::report::kPageTemplate, from PAGE_DIR/report.html with
# report.css, the list SCRIPTS and the plot library in UPLOT_DIR put in place.

if(NOT EXISTS ${UPLOT_DIR}/dist/uPlot.iife.min.js)
  message(FATAL_ERROR "The plot library is missing at ${UPLOT_DIR}. "
    "Run toolchain/setup, or: npm ci --prefix host_tools/report")
endif()

file(READ ${PAGE_DIR}/report.html page)
file(READ ${PAGE_DIR}/report.css style)
file(READ ${UPLOT_DIR}/dist/uPlot.iife.min.js uplot_script)
file(READ ${UPLOT_DIR}/dist/uPlot.min.css uplot_style)
file(READ ${UPLOT_DIR}/LICENSE uplot_license)
set(script "")
foreach(file IN LISTS SCRIPTS)
  file(READ ${file} text)
  string(APPEND script "${text}\n")
endforeach()

string(REPLACE "{{uplot_license}}" "${uplot_license}" page "${page}")
string(REPLACE "{{uplot_style}}" "${uplot_style}" page "${page}")
string(REPLACE "{{uplot_script}}" "${uplot_script}" page "${page}")
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")

file(WRITE ${OUTPUT}.new "// Assembled by host_tools/report/embed_page.cmake.
#include \"host_tools/report/page_template.h\"

namespace stilt::report {
const std::string_view kPageTemplate = R\"STILT_PAGE(${page})STILT_PAGE\";
}  // namespace stilt::report
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
