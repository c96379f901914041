#include "codegen/urdf/shape_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string_view>

#include "codegen/urdf/urdf_error.h"

namespace stilt::codegen {
namespace {

constexpr double kStraight_m = 1e-9;
constexpr double kStraight_rad = 1e-9;
constexpr double kEqual = 1e-9;  // relative

std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

std::string_view without_side(std::string_view name) {
  return name.ends_with("_L") || name.ends_with("_R") ? name.substr(0, name.size() - 2) : name;
}

bool on_other_sides(std::string_view a, std::string_view b) {
  return (a.ends_with("_L") && b.ends_with("_R")) || (a.ends_with("_R") && b.ends_with("_L"));
}

/// Reads and checks the numbers of one tree.
class ShapeReader {
 public:
  ShapeReader(const PlanarTree& tree, const std::string& source) : tree_(tree), source_(source) {}

  std::vector<ShapeNumber> read() {
    add_base();
    std::vector<std::vector<ShapeNumber>> legs;
    for (int k = 1; k < tree_.link_count(); ++k) {
      if (link(k).parent == 0) legs.push_back(leg(k));
    }
    if (legs.size() != 2) {
      fail("link '" + link(0).name + "' carries " + std::to_string(legs.size()) +
           " legs; it must carry a left and a right one");
    }
    check_equal(legs[0], legs[1]);
    numbers_.insert(numbers_.end(), legs[0].begin(), legs[0].end());
    return numbers_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UrdfError(source_ + ": " + what + "."); }

  [[nodiscard]] const PlanarLink& link(int index) const {
    return tree_.links[static_cast<std::size_t>(index)];
  }

  void add_base() {
    const PlanarLink& base = link(0);
    check_com(base);
    numbers_ = {{number_name(base, ShapeQuantity::mass_kg), base.mass_kg},
                {number_name(base, ShapeQuantity::com_m), base.com_m.z},
                {number_name(base, ShapeQuantity::inertia_kg_m2), base.inertia_kg_m2}};
    for (const PlanarFoot& foot : tree_.feet) {
      if (foot.link == 0) fail("foot frame '" + foot.name + "' is fixed to the base; it must end a leg");
      if (on_other_sides(foot.name, link(foot.link).name)) {
        fail("foot frame '" + foot.name + "' is fixed to link '" + link(foot.link).name +
             "'; foot_L must end the left leg and foot_R the right one");
      }
    }
    for (int k = 1; k < tree_.link_count(); ++k) {
      const PlanarJoint& joint = link(k).joint;
      if (link(k).parent != 0) continue;
      if (std::hypot(joint.origin_m.x, joint.origin_m.z) > kStraight_m) {
        fail("joint '" + joint.name + "' stands at x " + text(joint.origin_m.x) + " m, z " +
             text(joint.origin_m.z) + " m of link '" + base.name +
             "'; both hips must stand at its origin: give them the origin 0 0 0 and move the frame of '" +
             base.name + "' there");
      }
    }
  }

  /// Numbers of the links from `hip` down.
  [[nodiscard]] std::vector<ShapeNumber> leg(int hip) const {
    std::vector<ShapeNumber> numbers;
    for (int k = hip; k >= 0; k = next(k)) {
      const PlanarLink& own = link(k);
      check_joint(own);
      check_com(own);
      numbers.push_back({number_name(own, ShapeQuantity::mass_kg), own.mass_kg});
      numbers.push_back({number_name(own, ShapeQuantity::com_m), -own.com_m.z});
      numbers.push_back({number_name(own, ShapeQuantity::inertia_kg_m2), own.inertia_kg_m2});
      numbers.push_back({number_name(own, ShapeQuantity::length_m), length_m(k)});
    }
    return numbers;
  }

  /// The link that `index` carries; -1 for the last link of a leg.
  [[nodiscard]] int next(int index) const {
    int result = -1;
    for (int k = index + 1; k < tree_.link_count(); ++k) {
      if (link(k).parent != index) continue;
      if (result >= 0)
        fail("link '" + link(index).name + "' carries two joints; a link of a leg may carry one");
      result = k;
    }
    return result;
  }

  void check_joint(const PlanarLink& own) const {
    if (own.joint.direction < 0.0) {
      fail("joint '" + own.joint.name +
           "' turns about -y; its axis must be 0 1 0, so that a positive angle swings the lower link "
           "backward");
    }
    if (std::abs(own.joint.angle_offset_rad) > kStraight_rad) {
      fail("joint '" + own.joint.name + "' is turned by " + text(own.joint.angle_offset_rad) +
           " rad against link '" + link(own.parent).name +
           "'; links must hang straight at zero angle: its origin must have rpy 0 0 0");
    }
  }

  void check_com(const PlanarLink& own) const {
    if (std::abs(own.com_m.x) > kStraight_m) {
      fail("link '" + own.name + "' has its centre of mass at x " + text(own.com_m.x) +
           " m; it must be on the line through its joints, x 0");
    }
  }

  [[nodiscard]] double length_m(int index) const {
    const int child = next(index);
    if (child >= 0)
      return below(link(index), "joint '" + link(child).joint.name + "'", link(child).joint.origin_m);
    for (const PlanarFoot& foot : tree_.feet) {
      if (foot.link == index) return below(link(index), "foot frame '" + foot.name + "'", foot.position_m);
    }
    fail("link '" + link(index).name +
         "' ends a leg without a foot; add a massless link foot_L or foot_R to it");
  }

  [[nodiscard]] double below(const PlanarLink& own, const std::string& what, PlanarVector position_m) const {
    if (std::abs(position_m.x) > kStraight_m || !(position_m.z < 0.0)) {
      fail(what + " stands at x " + text(position_m.x) + " m, z " + text(position_m.z) + " m of link '" +
           own.name + "'; links must be straight: it must stand at x 0, below the link's own joint");
    }
    return -position_m.z;
  }

  void check_equal(const std::vector<ShapeNumber>& left, const std::vector<ShapeNumber>& right) const {
    for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
      if (i >= left.size() || i >= right.size() || left[i].name != right[i].name) {
        fail(
            "the legs have different links; right links must have the names of the left ones with _R for _L");
      }
      if (std::abs(left[i].value - right[i].value) > kEqual * std::abs(left[i].value)) {
        fail(left[i].name + " is " + text(left[i].value) + " for the left leg and " + text(right[i].value) +
             " for the right one; both legs must be equal");
      }
    }
  }

  const PlanarTree& tree_;
  const std::string& source_;
  std::vector<ShapeNumber> numbers_;
};

}  // namespace

std::string number_name(const PlanarLink& link, ShapeQuantity quantity) {
  const std::string name(without_side(link.name));
  switch (quantity) {
    case ShapeQuantity::mass_kg:
      return name + "_mass_kg";
    case ShapeQuantity::com_m:
      return name + "_com_m";
    case ShapeQuantity::inertia_kg_m2:
      return name + "_inertia_kg_m2";
    case ShapeQuantity::length_m:
      break;
  }
  return name + "_length_m";
}

std::vector<ShapeNumber> shape_numbers(const PlanarTree& tree, const std::string& source) {
  return ShapeReader(tree, source).read();
}

}  // namespace stilt::codegen
