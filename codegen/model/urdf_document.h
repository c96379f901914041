#pragma once

#include <map>
#include <string>
#include <vector>

namespace stilt::codegen {

/// What <transmission> says about a joint's motor.
struct Transmission {
  double gear_ratio = 1.0;
  double rotor_inertia_kg_m2 = 0.0;
};

/// What the XML says before any geometry is interpreted.
struct UrdfDocument {
  std::string text;
  std::vector<std::string> joint_names;  ///< in the order of the document
  std::map<std::string, Transmission> transmissions;
};

/// Reads the XML of a URDF, checks that links and joints form one tree and collects the transmissions.
/// @throws UrdfError with one sentence.
[[nodiscard]] UrdfDocument read_urdf_document(const std::string& file);

}  // namespace stilt::codegen
