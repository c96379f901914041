# cmake -DROOT=... -DOUTPUT=... -DHEADER=... -DNAMESPACE=... -DTYPE=... -DFUNCTION=... -DNAMED_BY=FILE|FOLDER
#   -P embed_texts.cmake -- FILE...
# Writes a C++ source that defines FUNCTION of HEADER. The function gives the texts of the files, each with its name,
# which is that of the file or of its folder. FILE is relative to ROOT, the root of the project; NAME=FILE names it
# otherwise.
set(rows "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(index RANGE ${last})
  set(path "${CMAKE_ARGV${index}}")
  if(path MATCHES "\\.(toml|urdf)$")
    get_filename_component(name "${path}" NAME_WE)
    if(path MATCHES "^([^=]+)=(.+)$")
      set(name "${CMAKE_MATCH_1}")
      set(path "${CMAKE_MATCH_2}")
    endif()
    if(NAMED_BY STREQUAL FOLDER)
      get_filename_component(folder "${path}" DIRECTORY)
      get_filename_component(name "${folder}" NAME)
    endif()
    file(READ "${ROOT}/${path}" text)
    string(APPEND rows "    {\"${name}\", \"${path}\", R\"text(${text})text\"},\n")
  endif()
endforeach()
file(WRITE "${OUTPUT}"
"#include \"${HEADER}\"

namespace ${NAMESPACE} {

std::span<const ${TYPE}> ${FUNCTION}() {
  static constexpr ${TYPE} kShipped[] = {
${rows}  };
  return kShipped;
}

}  // namespace ${NAMESPACE}
")
