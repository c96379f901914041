#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "codegen/urdf/planar_tree.h"
#include "host_tools/simulation/plant/mjcf.h"

namespace stilt::testing_support {

/// A planar tree in MuJoCo, without contact: the oracle of the generated dynamics.
class MujocoRobot {
 public:
  explicit MujocoRobot(const codegen::PlanarTree& tree) {
    simulation::MjcfOptions options;
    options.contacts = false;
    options.joint_losses = false;  // Coulomb friction is no part of the generated dynamics
    const std::string text = simulation::to_mjcf(tree, options);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    char message[1000] = "";
    model_.reset(mj_loadXML("robot.xml", files.get(), message, sizeof message));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(message);
    data_.reset(mj_makeData(model_.get()));
    for (const codegen::PlanarFoot& foot : tree.feet) {
      sites_.push_back(mj_name2id(model_.get(), mjOBJ_SITE, foot.name.c_str()));
    }
  }

  [[nodiscard]] int size() const { return model_->nv; }

  /// Armature and damping of each joint.
  void set_joint(int joint, double armature_kg_m2, double damping_Nm_s) {
    model_->dof_armature[3 + joint] = armature_kg_m2;
    model_->dof_damping[3 + joint] = damping_Nm_s;
  }

  /// Position and velocity, then the acceleration under torques and forces [fx, fz] on each foot.
  void forward(const double* x, const double* joint_torque_Nm, const double* foot_force_N) {
    mju_copy(data_->qpos, x, size());
    mju_copy(data_->qvel, x + size(), size());
    mju_zero(data_->qfrc_applied, size());
    mj_fwdPosition(model_.get(), data_.get());
    for (std::size_t f = 0; f < sites_.size(); ++f) {
      const std::vector<double> jacobian = foot_jacobian(static_cast<int>(f));
      for (int i = 0; i < size(); ++i) {
        for (int axis = 0; axis < 2; ++axis) {
          data_->qfrc_applied[i] += jacobian[static_cast<std::size_t>(axis * size() + i)] *
                                    foot_force_N[2 * f + static_cast<std::size_t>(axis)];
        }
      }
    }
    for (int j = 0; j + 3 < size(); ++j) data_->qfrc_applied[3 + j] += joint_torque_Nm[j];
    mj_forward(model_.get(), data_.get());
    mj_rnePostConstraint(model_.get(), data_.get());
  }

  [[nodiscard]] std::vector<double> mass_matrix() const {
    std::vector<double> matrix(static_cast<std::size_t>(size() * size()));
    mj_fullM(model_.get(), matrix.data(), data_->qM);
    return matrix;
  }
  [[nodiscard]] const double* bias() const { return data_->qfrc_bias; }
  [[nodiscard]] const double* acceleration() const { return data_->qacc; }

  /// Of all links, after forward(): mass; centre of mass, x, y, z, m; velocity of it, m/s; angular momentum
  /// about it, kg m^2/s.
  [[nodiscard]] double mass_kg() const { return model_->body_subtreemass[0]; }
  [[nodiscard]] const double* centre_of_mass_m() const { return data_->subtree_com; }
  [[nodiscard]] const double* velocity_m_s() const {
    mj_subtreeVel(model_.get(), data_.get());
    return data_->subtree_linvel;
  }
  [[nodiscard]] const double* angular_momentum() const {
    mj_subtreeVel(model_.get(), data_.get());
    return data_->subtree_angmom;
  }

  /// Rows x and z.
  [[nodiscard]] std::vector<double> foot_jacobian(int foot) const {
    const auto n = static_cast<std::size_t>(size());
    std::vector<double> full(3 * n);
    mj_jacSite(model_.get(), data_.get(), full.data(), nullptr, sites_[static_cast<std::size_t>(foot)]);
    full.erase(full.begin() + static_cast<std::ptrdiff_t>(n),
               full.begin() + static_cast<std::ptrdiff_t>(2 * n));
    return full;
  }
  [[nodiscard]] std::vector<double> foot_position(int foot) const {
    const double* p = data_->site_xpos + 3 * sites_[static_cast<std::size_t>(foot)];
    return {p[0], p[2]};
  }
  [[nodiscard]] std::vector<double> foot_velocity(int foot) const {
    double v[6];
    mj_objectVelocity(model_.get(), data_.get(), mjOBJ_SITE, sites_[static_cast<std::size_t>(foot)], v, 0);
    return {v[3], v[5]};
  }
  /// MuJoCo's accelerations contain that of gravity.
  [[nodiscard]] std::vector<double> foot_acceleration(int foot) const {
    double a[6];
    mj_objectAcceleration(model_.get(), data_.get(), mjOBJ_SITE, sites_[static_cast<std::size_t>(foot)], a,
                          0);
    return {a[3], a[5] - 9.81};
  }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::vector<int> sites_;
};

}  // namespace stilt::testing_support
