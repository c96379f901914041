#include "firmware/robots/robots.h"

#include <algorithm>
#include <cstddef>
#include <list>
#include <mutex>
#include <optional>
#include <vector>

#include "codegen/urdf/shape_numbers.h"
#include "codegen/urdf/urdf_error.h"
#include "codegen/urdf/urdf_reader.h"
#include "firmware/diagnostics/input_file.h"

// Robots as data: docs/decisions/0016-robots-as-data.md
namespace stilt::robots {
namespace {

namespace five_link = generated::five_link;

/// The error's sentence without its full stop, as all messages of programs are.
std::string sentence(const codegen::UrdfError& error) {
  std::string text = error.what();
  if (text.ends_with('.')) text.pop_back();
  return text;
}

/// What is wrong with the joints or links, as the sentence's rest; nothing when names and order are valid.
std::optional<std::string> wrong_names(const codegen::PlanarTree& tree,
                                       const std::vector<codegen::ShapeNumber>& numbers) {
  std::string found;
  std::string right;
  bool same = tree.joint_count() == model::kJoints;
  for (int j = 0; j < tree.joint_count(); ++j) {
    const std::string& name = tree.links[static_cast<std::size_t>(j) + 1].joint.name;
    found += (j > 0 ? ", " : "") + name;
    same = same && name == five_link::kJointNames[j];
  }
  for (int j = 0; j < model::kJoints; ++j)
    right += (j > 0 ? ", " : "") + std::string(five_link::kJointNames[j]);
  if (!same) return "the joints are " + found + "; they must be " + right;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i].name != five_link::kNumberNames[i])
      return "there is " + numbers[i].name + " in place of " + five_link::kNumberNames[i] +
             "; links must be torso, thigh_L, shin_L, thigh_R, shin_R";
  }
  return std::nullopt;
}

/// gait::leg_angles() bends knees to positive angles alone.
std::optional<std::string> wrong_knees(const codegen::PlanarTree& tree) {
  for (int j = 1; j < model::kJoints; j += 2) {
    const codegen::PlanarJoint& knee = tree.links[static_cast<std::size_t>(j) + 1].joint;
    if (knee.position_max_rad > 0.0) continue;
    return "the upper limit of joint '" + knee.name +
           "' must be above 0: knees bend to positive angles, which swing the shin backward";
  }
  return std::nullopt;
}

model::RobotConstants constants_of(const codegen::PlanarTree& tree,
                                   const std::vector<codegen::ShapeNumber>& numbers) {
  model::RobotConstants constants{};
  for (std::size_t i = 0; i < numbers.size(); ++i) constants.numbers[i] = numbers[i].value;
  for (int j = 0; j < model::kJoints; ++j) {
    const codegen::PlanarJoint& joint = tree.links[static_cast<std::size_t>(j) + 1].joint;
    constants.position_min_rad[j] = joint.position_min_rad;
    constants.position_max_rad[j] = joint.position_max_rad;
    constants.velocity_limit_rad_s[j] = joint.velocity_max_rad_s;
    constants.torque_limit_Nm[j] = joint.torque_max_Nm;
    constants.joint_parameters[j] = joint.armature_kg_m2();
    constants.joint_parameters[model::kJoints + j] = joint.damping_Nm_s;
  }
  return constants;
}

/// Robots that were found, for the life of the program.
class Registry {
 public:
  std::expected<const Robot*, std::string> find(std::string_view name) {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find(robots_, name, &Robot::name);
    if (known != robots_.end()) return &*known;
    return add(read(name));
  }

  std::expected<const Robot*, std::string> keep(std::string_view name, std::string_view urdf) {
    const std::lock_guard lock(mutex_);
    const auto known = std::ranges::find(robots_, name, &Robot::name);
    if (known != robots_.end() && known->urdf == urdf) return &*known;
    return add(parse(name, urdf));
  }

 private:
  /// The newest of a name comes first.
  std::expected<const Robot*, std::string> add(std::expected<Robot, std::string> robot) {
    if (!robot) return std::unexpected(robot.error());
    Robot& kept = robots_.emplace_front(std::move(*robot));
    kept.model.constants.name = kept.name.c_str();
    return &kept;
  }

  static std::expected<Robot, std::string> read(std::string_view name) {
    if (is_file(name)) {
      const auto text = diagnostics::read_file(std::string(name));
      if (text && !text->empty()) return parse(name, *text);
      return std::unexpected(std::string(name) +
                             (text ? ": is empty" : ": cannot be read (" + text.error() + ")") +
                             "; give the path of a URDF file");
    }
    for (const ShippedUrdf& shipped : shipped_urdfs()) {
      if (shipped.name == name) return parse(name, shipped.text);
    }
    return std::unexpected("there is no robot \"" + std::string(name) + "\"; known robots are " +
                           shipped_names() + "; or give a file that ends in .urdf");
  }

  std::mutex mutex_;
  std::list<Robot> robots_;
};

Registry& registry() {
  static Registry registry;
  return registry;
}

}  // namespace

std::string shipped_names() {
  std::string names;
  for (const ShippedUrdf& shipped : shipped_urdfs())
    names += (names.empty() ? "" : ", ") + std::string(shipped.name);
  return names;
}

bool is_file(std::string_view robot) noexcept { return robot.ends_with(".urdf"); }

std::expected<Robot, std::string> parse(std::string_view name, std::string_view urdf) {
  Robot robot{.name = std::string(name), .urdf = std::string(urdf), .tree = {}, .model = {}};
  try {
    robot.tree = codegen::parse_urdf(robot.urdf, robot.name);
    const std::vector<codegen::ShapeNumber> numbers = codegen::shape_numbers(robot.tree, robot.name);
    if (const auto wrong = wrong_names(robot.tree, numbers)) {
      return std::unexpected(robot.name + ": " + *wrong);
    }
    if (const auto wrong = wrong_knees(robot.tree)) return std::unexpected(robot.name + ": " + *wrong);
    robot.model = model::make_robot(constants_of(robot.tree, numbers));
  } catch (const codegen::UrdfError& error) {
    return std::unexpected(sentence(error));
  }
  return robot;
}

std::expected<const Robot*, std::string> find(std::string_view robot) { return registry().find(robot); }

std::expected<const Robot*, std::string> keep(std::string_view name, std::string_view urdf) {
  return registry().keep(name, urdf);
}

std::expected<const Robot*, std::string> of_run(std::string_view name, std::string_view urdf) {
  const bool is_shipped =
      std::ranges::find(shipped_urdfs(), name, &ShippedUrdf::name) != shipped_urdfs().end();
  return is_shipped || urdf.empty() ? find(name) : keep(name, urdf);
}

}  // namespace stilt::robots
