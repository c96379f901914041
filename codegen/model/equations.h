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

/// Accelerations (or, at an impact, velocity jumps) and forces (or impulses) in absolute link coordinates.
struct AbsoluteMotion {
  PlanarExpression base_acceleration;   ///< of the base frame's origin, gravity g added to z
  Row rate;                             ///< absolute angular rate of each link
  Row acceleration;                     ///< absolute angular acceleration of each link
  std::vector<PlanarExpression> force;  ///< on each foot, world frame
};

/// The numbers of a planar tree as expressions: constants of one robot, or parameters for every robot of a
/// shape.
struct TreeNumbers {
  struct Link {
    Expression mass_kg;
    PlanarExpression com_m;       ///< in the link's frame
    Expression inertia_kg_m2;     ///< about the centre of mass
    PlanarExpression origin_m;    ///< of its joint, in the parent's frame
    Expression angle_offset_rad;  ///< against the parent's frame at joint angle zero
  };
  std::vector<Link> links;
  std::vector<PlanarExpression> feet_m;  ///< in the frames of their links
};

/// The numbers of one robot as constants.
[[nodiscard]] TreeNumbers constant_numbers(Graph& graph, const PlanarTree& tree);

/// Left-hand sides of the equations of motion, M a + bias - J' f, by the robot's coordinates.
struct EquationRows {
  Row row;  ///< x, z, pitch of the base, then the joints; armature and damping not included
};

/// Equations of motion of a planar tree over expressions.
///
/// They are written in absolute link angles (each sine and cosine once per link, rates and accelerations are
/// sums along the chains) with augmented bodies: for link k with the masses of all its subtrees attached at
/// its joints, D_k is the first moment about the link's joint and H_k the second moment. With T(r) = (r_z,
/// -r_x), the derivative of a body-fixed vector by its angle, and O_kc the body-fixed vector from k's joint
/// to child c's:
///   inertial force of the link     A_k = alpha_k T(D_k) - omega_k^2 D_k
///   net force on a subtree         W_k = A_k + sum over children W_c - sum over own feet f
///   acceleration of child's joint  a_c = a_k + alpha_k T(O_kc) - omega_k^2 O_kc
///   moment about k's joint         N_k = H_k alpha_k + T(D_k).a_k + sum T(O_kc).W_c - sum over own feet
///   T(O_f).f base rows                      m a_root + W_root = 0, sum of all N_k = 0 row of joint i sum of
///   N_k over the links beyond the joint = motor torque
class Equations {
 public:
  /// Of one robot.
  Equations(Graph& graph, const PlanarTree& tree);
  /// Of every robot with the links, joints and feet of `shape`, whose numbers `numbers` takes the place of.
  Equations(Graph& graph, const PlanarTree& shape, TreeNumbers numbers);

  [[nodiscard]] Graph& graph() const { return graph_; }
  [[nodiscard]] const PlanarTree& tree() const { return tree_; }
  [[nodiscard]] const Row& angles() const { return angle_; }  ///< absolute, one a link
  [[nodiscard]] const Row& rates() const { return rate_; }    ///< absolute, one a link

  /// Symbols of the emitted functions' arguments.
  [[nodiscard]] Expression position(int index) const;
  [[nodiscard]] Expression velocity(int index) const;
  [[nodiscard]] Expression input(int index) const;
  [[nodiscard]] Expression armature(int joint) const;
  [[nodiscard]] Expression damping(int joint) const;

  /// Sums along the chains: absolute values of all links from the root's and the joints' values.
  [[nodiscard]] Row chain_sums(Expression root, const Row& joints) const;
  /// Sums over subtrees: derivatives by (or forces along) pitch and joints from those by absolute angles.
  [[nodiscard]] Row subtree_sums(const Row& by_link) const;
  /// d rows / d variable of each link, columns summed to pitch and joints.
  [[nodiscard]] Matrix jacobian(const Row& rows, const Row& variables, Differentiator& differentiate) const;

  [[nodiscard]] EquationRows equations(const AbsoluteMotion& motion) const;
  /// Mass matrix over all coordinates; armature not included.
  [[nodiscard]] Matrix mass_matrix() const;

  [[nodiscard]] PlanarExpression foot_position(int foot) const;
  [[nodiscard]] PlanarExpression foot_velocity(int foot) const;
  /// Acceleration of a foot under a motion whose base acceleration contains gravity (subtracted again).
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
