#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace stilt::codegen {

/// Data of a joint's motor in <transmission>, below <robot> or below <ros2_control>.
struct Transmission {
  double gear_ratio = 1.0;
  std::optional<double> rotor_inertia_kg_m2;  ///< nothing where the URDF does not state it
};

/// Content of the XML before its geometry is interpreted.
struct UrdfDocument {
  std::vector<std::string> joint_names;  ///< in the order of the document
  std::map<std::string, Transmission> transmissions;
};

/// Reads a file as text. @throws UrdfError if it cannot be read or is empty.
[[nodiscard]] std::string read_text(const std::string& file);

/// Parses the XML of a URDF, checks that links and joints form one tree, and collects the transmissions.
/// @throws UrdfError with one sentence that begins with `source`.
[[nodiscard]] UrdfDocument parse_urdf_document(const std::string& text, const std::string& source);

}  // namespace stilt::codegen
