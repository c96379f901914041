#pragma once

#include <vector>

#include "codegen/expression/differentiate.h"
#include "codegen/expression/graph.h"
#include "codegen/urdf/planar_tree.h"

namespace stilt::codegen {

using Row = std::vector<Expression>;
using Matrix = std::vector<Row>;

/// A vector of the x-z plane.
struct PlanarExpression {
  Expression x;
  Expression z;
};

/// Accelerations (at an impact: velocity jumps) and forces (at an impact: impulses) in absolute link
/// coordinates.
struct AbsoluteMotion {
  PlanarExpression base_acceleration;   ///< of the origin of the base frame, with gravity g added to z
  Row rate;                             ///< absolute angular rate of each link
  Row acceleration;                     ///< absolute angular acceleration of each link
  std::vector<PlanarExpression> force;  ///< on each foot, world frame
};

/// The numbers of a planar tree as expressions: constants of one robot, or parameters for all robots of a
/// shape.
struct TreeNumbers {
  struct Link {
    Expression mass_kg;
    PlanarExpression com_m;       ///< in the link's frame
    Expression inertia_kg_m2;     ///< about the centre of mass
    PlanarExpression origin_m;    ///< of its joint, in the parent's frame
    Expression angle_offset_rad;  ///< relative to the parent's frame at joint angle zero
  };
  std::vector<Link> links;
  std::vector<PlanarExpression> feet_m;  ///< in the frames of their links
};

/// The numbers of one robot as constants.
[[nodiscard]] TreeNumbers constant_numbers(Graph& graph, const PlanarTree& tree);

/// Left-hand sides of the equations of motion, M a + bias - J' f, one per coordinate of the robot.
struct EquationRows {
  Row row;  ///< x, z, pitch of the base, then the joints; without armature and damping
};

// clang-format off
// Equations of motion of a planar tree over expressions.
//
// They use absolute link angles: each sine and cosine occurs once per link, and rates and accelerations are
// sums along the chains. They use augmented bodies: link k carries the masses of all its subtrees at its
// joints. D_k is the first moment about the link's joint and H_k the second moment. T(r) = (r_z, -r_x) is
// the derivative of a body-fixed vector by its angle. O_kc is the body-fixed vector from k's joint to child
// c's.
//
//   inertial force of the link     A_k = alpha_k T(D_k) - omega_k^2 D_k
//   net force on a subtree         W_k = A_k + sum over children W_c - sum over own feet f
//   acceleration of child's joint  a_c = a_k + alpha_k T(O_kc) - omega_k^2 O_kc
//   moment about k's joint         N_k = H_k alpha_k + T(D_k).a_k + sum T(O_kc).W_c - sum over feet T(O_f).f
//   base rows                      m a_root + W_root = 0, sum of all N_k = 0
//   row of joint i                 sum of N_k over the links beyond the joint = motor torque
// clang-format on
class Equations {
 public:
  /// Equations of one robot.
  Equations(Graph& graph, const PlanarTree& tree);
  /// Equations of every robot with the links, joints and feet of `shape`; `numbers` replaces its numbers.
  Equations(Graph& graph, const PlanarTree& shape, TreeNumbers numbers);

  [[nodiscard]] Graph& graph() const { return graph_; }
  [[nodiscard]] const PlanarTree& tree() const { return tree_; }
  [[nodiscard]] const Row& angles() const { return angle_; }  ///< absolute, one per link
  [[nodiscard]] const Row& rates() const { return rate_; }    ///< absolute, one per link

  /// Symbols for the arguments of the emitted functions.
  [[nodiscard]] Expression position(int index) const;
  [[nodiscard]] Expression velocity(int index) const;
  [[nodiscard]] Expression input(int index) const;
  [[nodiscard]] Expression armature(int joint) const;
  [[nodiscard]] Expression damping(int joint) const;

  /// Sums along the chains: absolute values of all links from the values of the root and the joints.
  [[nodiscard]] Row chain_sums(Expression root, const Row& joints) const;
  /// Sums over subtrees: converts derivatives by absolute angles (or forces along them) to pitch and joints.
  [[nodiscard]] Row subtree_sums(const Row& by_link) const;
  /// d rows / d variable of each link, with columns summed to pitch and joints.
  [[nodiscard]] Matrix jacobian(const Row& rows, const Row& variables, Differentiator& differentiate) const;

  [[nodiscard]] EquationRows equations(const AbsoluteMotion& motion) const;
  /// Mass matrix over all coordinates, without armature.
  [[nodiscard]] Matrix mass_matrix() const;

  [[nodiscard]] PlanarExpression foot_position(int foot) const;
  [[nodiscard]] PlanarExpression foot_velocity(int foot) const;
  /// Acceleration of a foot. The base acceleration of the motion contains gravity, which is subtracted.
  [[nodiscard]] PlanarExpression foot_acceleration(int foot, const AbsoluteMotion& motion) const;
  /// d foot position / d coordinates, two rows.
  [[nodiscard]] Matrix foot_jacobian(int foot) const;

 private:
  [[nodiscard]] PlanarExpression rotate(int link, const PlanarExpression& v) const;
  [[nodiscard]] PlanarExpression turn(int link, const PlanarExpression& v,
                                      const AbsoluteMotion& motion) const;
  [[nodiscard]] std::vector<PlanarExpression> origin_accelerations(const AbsoluteMotion& motion) const;

  Graph& graph_;
  const PlanarTree& tree_;
  TreeNumbers numbers_;
  Expression mass_;
  Row angle_;
  Row sine_;
  Row cosine_;
  Row rate_;
  std::vector<PlanarExpression> augmented_moment_;  ///< D_k in the link's frame
  Row augmented_inertia_;                           ///< H_k
};

inline constexpr double kGravity_m_s2 = 9.81;

}  // namespace stilt::codegen
