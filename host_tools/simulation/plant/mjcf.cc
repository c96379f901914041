#include "host_tools/simulation/plant/mjcf.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <sstream>

namespace stilt::simulation {
namespace {

using codegen::PlanarFoot;
using codegen::PlanarJoint;
using codegen::PlanarLink;
using codegen::PlanarTree;
using codegen::PlanarVector;

constexpr double kGroundHalfLength_m = 100.0;  // of blocks; to contacts a plane has no end
constexpr double kGroundHalfWidth_m = 5.0;
constexpr double kGroundHalfDepth_m = 0.5;

/// The shortest decimal texts that read back exactly, separated by spaces.
std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    char buffer[40];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    if (!text.empty()) text += ' ';
    text.append(buffer, end);
  }
  return text;
}

/// Quaternion of a rotation about +y.
std::string pitch_quaternion(double angle_rad) {
  return numbers({std::cos(0.5 * angle_rad), 0.0, std::sin(0.5 * angle_rad), 0.0});
}

class MjcfWriter {
 public:
  MjcfWriter(const PlanarTree& tree, const MjcfOptions& options) : tree_(tree), options_(options) {}

  std::string run() {
    out_ << "<mujoco model=\"" << tree_.name << "\">\n"
         << "  <compiler angle=\"radian\" inertiafromgeom=\"false\"/>\n"
         << "  <option timestep=\"" << numbers({options_.time_step_s})
         << "\" gravity=\"0 0 -9.81\" cone=\"elliptic\""
         << " solver=\"Newton\" iterations=\"100\" tolerance=\"1e-12\" impratio=\""
         << numbers({options_.friction_to_normal_impedance}) << "\">\n"
         << "    <flag energy=\"enable\" contact=\"" << (options_.contacts ? "enable" : "disable") << "\"/>\n"
         << "  </option>\n  <worldbody>\n";
    ground();
    body(0, 2);
    out_ << "  </worldbody>\n";
    actuators();
    out_ << "</mujoco>\n";
    return out_.str();
  }

 private:
  void ground() {
    double level_m = 0.0;
    for (const GroundStep& step : options_.steps) level_m = std::min(level_m, step.height_m);
    out_ << "    <geom name=\"ground\" type=\"plane\" size=\""
         << numbers({kGroundHalfLength_m, kGroundHalfWidth_m, 1.0}) << "\" pos=\""
         << numbers({0.0, 0.0, level_m}) << "\" quat=\"" << pitch_quaternion(-options_.ground_slope_rad)
         << "\"" << contact("0", "1") << "/>\n";
    double from_m = -kGroundHalfLength_m;
    double height_m = 0.0;
    for (std::size_t i = 0; i <= options_.steps.size(); ++i) {
      const double to_m = i < options_.steps.size() ? options_.steps[i].position_m : kGroundHalfLength_m;
      if (height_m > level_m) box(static_cast<int>(i), from_m, to_m, height_m);
      if (i < options_.steps.size()) height_m = options_.steps[i].height_m;
      from_m = to_m;
    }
  }

  /// Adds a block of ground whose top reaches from one x to another, parallel to the slope.
  void box(int index, double from_m, double to_m, double height_m) {
    const double slope = options_.ground_slope_rad;
    const double middle_m = 0.5 * (from_m + to_m);
    const double half_length_m = 0.5 * (to_m - from_m) / std::cos(slope);
    const double x_m = middle_m + kGroundHalfDepth_m * std::sin(slope);
    const double z_m = middle_m * std::tan(slope) + height_m - kGroundHalfDepth_m * std::cos(slope);
    out_ << "    <geom name=\"ground_" << index << "\" type=\"box\" size=\""
         << numbers({half_length_m, kGroundHalfWidth_m, kGroundHalfDepth_m}) << "\" pos=\""
         << numbers({x_m, 0.0, z_m}) << "\" quat=\"" << pitch_quaternion(-slope) << "\"" << contact("0", "1")
         << "/>\n";
  }

  [[nodiscard]] std::string contact(const char* type, const char* affinity) const {
    std::ostringstream text;
    text << " contype=\"" << type << "\" conaffinity=\"" << affinity << "\" condim=\"3\" friction=\""
         << numbers({options_.friction, 0.0, 0.0}) << "\" solref=\""
         << numbers({options_.contact_time_constant_s, options_.contact_damping_ratio}) << "\" solimp=\""
         << numbers({options_.contact_impedance_min, options_.contact_impedance_max,
                     options_.contact_impedance_width_m})
         << "\"";
    return text.str();
  }

  void body(int index, int depth) {
    const PlanarLink& link = tree_.links[static_cast<std::size_t>(index)];
    const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
    const PlanarVector origin = index == 0 ? PlanarVector{} : link.joint.origin_m;
    const double angle_rad = index == 0 ? 0.0 : link.joint.angle_offset_rad;
    out_ << indent << "<body name=\"" << link.name << "\" pos=\"" << numbers({origin.x, 0.0, origin.z})
         << "\" quat=\"" << pitch_quaternion(angle_rad) << "\">\n";
    const std::string inner = indent + "  ";
    index == 0 ? root_joints(inner) : joint(link.joint, inner);
    const double i = link.inertia_kg_m2;
    out_ << inner << "<inertial pos=\"" << numbers({link.com_m.x, 0.0, link.com_m.z}) << "\" mass=\""
         << numbers({link.mass_kg}) << "\" diaginertia=\"" << numbers({i, i, i}) << "\"/>\n";
    if (index == 0) {
      site("hip", {}, inner);
      site("torso_com", link.com_m, inner);
    }
    for (const PlanarFoot& foot : tree_.feet) {
      if (foot.link == index) add_foot(foot, inner);
    }
    for (int child = index + 1; child < tree_.link_count(); ++child) {
      if (tree_.links[static_cast<std::size_t>(child)].parent == index) body(child, depth + 1);
    }
    out_ << indent << "</body>\n";
  }

  void root_joints(const std::string& indent) {
    out_ << indent << "<joint name=\"root_x\" type=\"slide\" axis=\"1 0 0\"/>\n"
         << indent << "<joint name=\"root_z\" type=\"slide\" axis=\"0 0 1\"/>\n"
         << indent << "<joint name=\"root_pitch\" type=\"hinge\" axis=\"0 1 0\"/>\n";
  }

  void joint(const PlanarJoint& joint, const std::string& indent) {
    const double armature = options_.armature ? joint.armature_kg_m2() : 0.0;
    const double damping = options_.joint_losses ? joint.damping_Nm_s : 0.0;
    const double friction = options_.joint_losses ? joint.friction_Nm : 0.0;
    out_ << indent << "<joint name=\"" << joint.name << "\" type=\"hinge\" axis=\""
         << numbers({0.0, joint.direction, 0.0}) << "\" armature=\"" << numbers({armature}) << "\" damping=\""
         << numbers({damping}) << "\" frictionloss=\"" << numbers({friction}) << "\" limited=\""
         << (options_.joint_limits ? "true" : "false") << "\" range=\""
         << numbers({joint.position_min_rad, joint.position_max_rad}) << "\"/>\n";
  }

  void site(const std::string& name, PlanarVector position, const std::string& indent) {
    out_ << indent << "<site name=\"" << name << "\" pos=\"" << numbers({position.x, 0.0, position.z})
         << "\" size=\"0.005\"/>\n";
  }

  /// The centre of the sphere is one radius from the foot frame towards the link's joint.
  void add_foot(const PlanarFoot& foot, const std::string& indent) {
    const double length_m = std::hypot(foot.position_m.x, foot.position_m.z);
    const double scale = length_m > 0.0 ? 1.0 - options_.foot_radius_m / length_m : 1.0;
    out_ << indent << "<geom name=\"" << foot.name << "\" type=\"sphere\" size=\""
         << numbers({options_.foot_radius_m}) << "\" mass=\"0\" pos=\""
         << numbers({scale * foot.position_m.x, 0.0, scale * foot.position_m.z}) << "\"" << contact("1", "0")
         << "/>\n";
    site(foot.name, foot.position_m, indent);
  }

  void actuators() {
    out_ << "  <actuator>\n";
    for (int j = 0; j < tree_.joint_count(); ++j) {
      const PlanarJoint& joint = tree_.links[static_cast<std::size_t>(j) + 1].joint;
      out_ << "    <motor name=\"" << joint.name << "\" joint=\"" << joint.name
           << "\" ctrllimited=\"true\" ctrlrange=\"" << numbers({-joint.torque_max_Nm, joint.torque_max_Nm})
           << "\"/>\n";
    }
    out_ << "  </actuator>\n";
  }

  const PlanarTree& tree_;
  const MjcfOptions& options_;
  std::ostringstream out_;
};

}  // namespace

std::string to_mjcf(const PlanarTree& tree, const MjcfOptions& options) {
  return MjcfWriter(tree, options).run();
}

}  // namespace stilt::simulation
