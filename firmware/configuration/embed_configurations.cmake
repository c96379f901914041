# cmake -DROOT=... -DOUTPUT=... -P embed_configurations.cmake -- FILE...
# Writes a C++ source with the text of the shipped configurations; a file's name is its robot's. FILE is
# relative to ROOT, the root of the project.
set(rows "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(index RANGE ${last})
  set(path "${CMAKE_ARGV${index}}")
  if(path MATCHES "\\.toml$")
    get_filename_component(robot "${path}" NAME_WE)
    file(READ "${ROOT}/${path}" text)
    string(APPEND rows "    {\"${robot}\", \"${path}\", R\"toml(${text})toml\"},\n")
  endif()
endforeach()
file(WRITE "${OUTPUT}"
"#include \"firmware/configuration/configuration.h\"

namespace stilt::configuration {

std::span<const ShippedConfiguration> shipped_configurations() {
  static constexpr ShippedConfiguration kShipped[] = {
${rows}  };
  return kShipped;
}

}  // namespace stilt::configuration
")
