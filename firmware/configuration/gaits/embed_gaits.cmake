# cmake -DROOT=... -DOUTPUT=... -P embed_gaits.cmake -- FILE...
# Writes a C++ source with the text of the shipped gaits; the folder of a file is its robot's name. FILE is
# relative to ROOT, the root of the project.
set(rows "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(index RANGE ${last})
  set(path "${CMAKE_ARGV${index}}")
  if(path MATCHES "\\.toml$")
    get_filename_component(folder "${path}" DIRECTORY)
    get_filename_component(robot "${folder}" NAME)
    file(READ "${ROOT}/${path}" text)
    string(APPEND rows "    {\"${robot}\", \"${path}\", R\"toml(${text})toml\"},\n")
  endif()
endforeach()
file(WRITE "${OUTPUT}"
"#include \"firmware/configuration/gaits/shipped_gaits.h\"

namespace stilt::gait_files {

std::span<const ShippedGait> shipped_gaits() {
  static constexpr ShippedGait kShipped[] = {
${rows}  };
  return kShipped;
}

}  // namespace stilt::gait_files
")
