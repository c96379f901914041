#include "codegen/urdf/urdf_reader.h"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "codegen/urdf/urdf_document.h"

namespace stilt::codegen {
namespace {

constexpr double kPlanarTolerance = 1e-9;

/// A frame in the plane: position and angle relative to the frame of the moving link.
struct PlanarPose {
  PlanarVector position_m;
  double angle_rad = 0.0;

  [[nodiscard]] PlanarVector apply(double x, double z) const {
    const double s = std::sin(angle_rad);
    const double c = std::cos(angle_rad);
    return {position_m.x + c * x + s * z, position_m.z - s * x + c * z};
  }
};

PlanarPose operator*(const PlanarPose& a, const PlanarPose& b) {
  return {a.apply(b.position_m.x, b.position_m.z), a.angle_rad + b.angle_rad};
}

int side(const std::string& name) {
  if (name.ends_with("_L")) return 0;
  if (name.ends_with("_R")) return 1;
  return 2;
}

/// Second moment about the y axis of the link's own frame, for any orientation of the inertial frame.
double inertia_about_y(const urdf::Inertial& inertial) {
  const urdf::Vector3 y = inertial.origin.rotation.GetInverse() * urdf::Vector3(0.0, 1.0, 0.0);
  return inertial.ixx * y.x * y.x + inertial.iyy * y.y * y.y + inertial.izz * y.z * y.z +
         2.0 * (inertial.ixy * y.x * y.y + inertial.ixz * y.x * y.z + inertial.iyz * y.y * y.z);
}

/// Keeps the first error of the URDF parser, which only logs some malformed elements and skips them.
class ErrorRecorder : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || !first_error_.empty()) return;
    first_error_ = text.substr(0, text.find_first_of("\r\n"));
    while (first_error_.ends_with('.') || first_error_.ends_with(' ')) first_error_.pop_back();
  }

  [[nodiscard]] const std::string& first_error() const { return first_error_; }

 private:
  std::string first_error_;
};

/// Walks a URDF depth first and builds the planar tree.
class TreeBuilder {
 public:
  TreeBuilder(const std::string& source, const UrdfDocument& document, const urdf::ModelInterface& model)
      : source_(source), document_(document), model_(model) {}

  PlanarTree build() {
    tree_.name = model_.getName();
    const urdf::Link& root = *model_.getRoot();
    PlanarLink base;
    base.name = root.name;
    tree_.links.push_back(base);
    visit(root, 0, {});
    for (const PlanarLink& link : tree_.links) check_mass(link);
    check_rotors();
    if (tree_.feet.empty()) {
      fail("there is no foot frame; add massless links foot_L and foot_R behind fixed joints");
    }
    std::ranges::stable_sort(tree_.feet, {}, [](const PlanarFoot& foot) { return side(foot.name); });
    return tree_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UrdfError(source_ + ": " + what + "."); }

  /// Adds `link`, at `pose` in moving link `index`, and all links that it carries.
  void visit(const urdf::Link& link, int index, const PlanarPose& pose) {
    merge(link, index, pose);
    if (link.name == "foot_L" || link.name == "foot_R") add_foot(link, index, pose);
    for (const urdf::JointConstSharedPtr& joint : ordered_joints(link)) {
      const PlanarPose at_joint = pose * planar_pose(*joint);
      const urdf::Link& child = *model_.getLink(joint->child_link_name);
      if (joint->type == urdf::Joint::FIXED) {
        visit(child, index, at_joint);
        continue;
      }
      PlanarLink moving;
      moving.name = child.name;
      moving.parent = index;
      moving.joint = planar_joint(*joint, at_joint);
      tree_.links.push_back(moving);
      visit(child, tree_.link_count() - 1, {});
    }
  }

  [[nodiscard]] std::vector<urdf::JointConstSharedPtr> ordered_joints(const urdf::Link& link) const {
    std::vector<urdf::JointConstSharedPtr> joints;
    for (const std::string& name : document_.joint_names) {
      const urdf::JointConstSharedPtr joint = model_.getJoint(name);
      if (joint != nullptr && joint->parent_link_name == link.name) joints.push_back(joint);
    }
    std::ranges::stable_sort(joints, {}, [](const auto& joint) { return side(joint->name); });
    return joints;
  }

  [[nodiscard]] PlanarPose planar_pose(const urdf::Joint& joint) const {
    const urdf::Pose& origin = joint.parent_to_joint_origin_transform;
    const urdf::Vector3 y = origin.rotation * urdf::Vector3(0.0, 1.0, 0.0);
    if (std::abs(y.y - 1.0) > kPlanarTolerance) {
      fail("not planar: the origin of joint '" + joint.name +
           "' is turned out of the x-z plane; only a pitch is allowed");
    }
    const urdf::Vector3 x = origin.rotation * urdf::Vector3(1.0, 0.0, 0.0);
    return {{origin.position.x, origin.position.z}, std::atan2(-x.z, x.x)};
  }

  [[nodiscard]] PlanarJoint planar_joint(const urdf::Joint& joint, const PlanarPose& pose) const {
    const std::string who = "joint '" + joint.name + "'";
    if (joint.type != urdf::Joint::REVOLUTE && joint.type != urdf::Joint::CONTINUOUS) {
      fail(who + " is neither revolute, continuous nor fixed; only those are supported");
    }
    const double axis_length = std::hypot(joint.axis.x, joint.axis.y, joint.axis.z);
    if (!(std::abs(joint.axis.y) / axis_length > 1.0 - kPlanarTolerance)) {
      fail("not planar: " + who + " does not turn about the y axis; its axis must be 0 1 0 or 0 -1 0");
    }
    if (joint.limits == nullptr || !(joint.limits->effort > 0.0) || !(joint.limits->velocity > 0.0)) {
      fail(who +
           " has no torque or speed limit; it needs <limit effort=\"...\" velocity=\"...\"/> above zero");
    }
    PlanarJoint result;
    result.name = joint.name;
    result.origin_m = pose.position_m;
    result.angle_offset_rad = pose.angle_rad;
    result.direction = joint.axis.y > 0.0 ? 1.0 : -1.0;
    const bool endless = joint.type == urdf::Joint::CONTINUOUS;
    result.position_min_rad = endless ? -1e3 : joint.limits->lower;
    result.position_max_rad = endless ? 1e3 : joint.limits->upper;
    if (!(result.position_min_rad < result.position_max_rad)) {
      fail(who + " has an empty range; <limit> needs lower below upper");
    }
    result.velocity_max_rad_s = joint.limits->velocity;
    result.torque_max_Nm = joint.limits->effort;
    if (joint.dynamics != nullptr) {
      result.damping_Nm_s = joint.dynamics->damping;
      result.friction_Nm = joint.dynamics->friction;
    }
    if (result.damping_Nm_s < 0.0 || result.friction_Nm < 0.0) {
      fail(who + " has negative damping or friction; <dynamics> needs numbers that are not negative");
    }
    if (const auto entry = document_.transmissions.find(joint.name); entry != document_.transmissions.end()) {
      result.gear_ratio = entry->second.gear_ratio;
      result.rotor_inertia_kg_m2 = entry->second.rotor_inertia_kg_m2.value_or(0.0);
    }
    return result;
  }

  /// Adds the mass of `link` to the moving link that carries it (parallel-axis theorem).
  void merge(const urdf::Link& link, int index, const PlanarPose& pose) {
    if (link.inertial == nullptr) return;
    const urdf::Inertial& inertial = *link.inertial;
    const PlanarVector com = pose.apply(inertial.origin.position.x, inertial.origin.position.z);
    if (!(inertial.mass >= 0.0) || !std::isfinite(inertial.mass)) {
      fail("link '" + link.name + "' has a mass that is negative or not a number");
    }
    PlanarLink& target = tree_.links[static_cast<std::size_t>(index)];
    const double mass = target.mass_kg + inertial.mass;
    if (mass == 0.0) return;
    const PlanarVector d{com.x - target.com_m.x, com.z - target.com_m.z};
    const double reduced = target.mass_kg * inertial.mass / mass;
    const double share = inertial.mass / mass;
    target.inertia_kg_m2 += inertia_about_y(inertial) + reduced * (d.x * d.x + d.z * d.z);
    target.com_m = {target.com_m.x + share * d.x, target.com_m.z + share * d.z};
    target.mass_kg = mass;
  }

  void add_foot(const urdf::Link& link, int index, const PlanarPose& pose) {
    if (link.inertial != nullptr && link.inertial->mass > 0.0) {
      fail("foot frame '" + link.name + "' has a mass; give the mass to the link that carries it");
    }
    const bool moves = link.parent_joint == nullptr || link.parent_joint->type != urdf::Joint::FIXED;
    if (moves)
      fail("foot frame '" + link.name + "' is not behind a fixed joint; a foot is a point of a moving link");
    tree_.feet.push_back({.name = link.name, .link = index, .position_m = pose.position_m});
  }

  /// A joint that was forgotten is not one without rotor: all joints have a rotor inertia, or none.
  void check_rotors() const {
    const auto stated = [this](const PlanarLink& link) {
      const auto entry = document_.transmissions.find(link.joint.name);
      return entry != document_.transmissions.end() && entry->second.rotor_inertia_kg_m2.has_value();
    };
    const auto moving = std::ranges::subrange(tree_.links.begin() + 1, tree_.links.end());
    const auto with = std::ranges::find_if(moving, stated);
    const auto without = std::ranges::find_if_not(moving, stated);
    if (with == moving.end() || without == moving.end()) return;
    fail("joint '" + without->joint.name + "' has no <rotorInertia> in a transmission, and joint '" +
         with->joint.name + "' has one; give all joints one, 0 where it is negligible");
  }

  void check_mass(const PlanarLink& link) const {
    if (!(link.mass_kg > 0.0)) {
      fail("moving link '" + link.name + "' has no mass; give it an <inertial> with a mass above zero");
    }
    if (!(link.inertia_kg_m2 > 0.0) || !std::isfinite(link.inertia_kg_m2)) {
      fail("moving link '" + link.name + "' has no moment of inertia about y; iyy must be above zero");
    }
  }

  const std::string& source_;
  const UrdfDocument& document_;
  const urdf::ModelInterface& model_;
  PlanarTree tree_;
};

}  // namespace

PlanarTree read_urdf(const std::string& file) { return parse_urdf(read_text(file), file); }

PlanarTree parse_urdf(const std::string& text, const std::string& source) {
  const UrdfDocument document = parse_urdf_document(text, source);
  ErrorRecorder recorder;
  console_bridge::useOutputHandler(&recorder);
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  console_bridge::restorePreviousOutputHandler();
  if (model == nullptr || !recorder.first_error().empty()) {
    throw UrdfError(source + ": the URDF parser refuses it: " + recorder.first_error() + ".");
  }
  return TreeBuilder(source, document, *model).build();
}

}  // namespace stilt::codegen
