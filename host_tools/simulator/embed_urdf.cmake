# Writes embedded_urdf.h: the text of each URDF named in URDFS, by the name of its file without extension.
set(rows "")
foreach(urdf ${URDFS})
  get_filename_component(name ${urdf} NAME_WE)
  file(READ ${urdf} text)
  string(APPEND rows "    EmbeddedUrdf{\"${name}\", R\"urdf(${text})urdf\"},\n")
endforeach()
file(WRITE ${OUTPUT} "#pragma once

#include <array>
#include <string_view>

namespace stilt::simulator {

/// A robot's description, compiled in.
struct EmbeddedUrdf {
  std::string_view name;
  std::string_view text;
};

inline constexpr std::array kEmbeddedUrdfs = {
${rows}};

}  // namespace stilt::simulator
")
