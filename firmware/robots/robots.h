#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "codegen/urdf/planar_tree.h"
#include "mpc_core/model/robot.h"

/// Robots as data: a URDF, read at start-up, gives the numbers of the controller's model and the simulator's
/// plant.
namespace stilt::robots {

/// A description compiled into the program.
struct ShippedUrdf {
  std::string_view name;  ///< of the robot, such as "amber3m"
  std::string_view path;  ///< of the file it was made from, relative to the root of the project
  std::string_view text;  ///< that file
};

/// The shipped descriptions, by name.
[[nodiscard]] std::span<const ShippedUrdf> shipped_urdfs();

/// Their names, separated by commas.
[[nodiscard]] std::string shipped_names();

/// A robot that the controller can plan for: hip_L, knee_L, hip_R, knee_R about +y, straight links, equal
/// legs.
struct Robot {
  std::string name;  ///< of a shipped robot, or the URDF file as it was given
  std::string urdf;  ///< text of the description
  codegen::PlanarTree tree;
  model::RobotModel model;  ///< its constants' name is `name`
};

/// Whether a robot is given as a file rather than by name: it ends in ".urdf".
[[nodiscard]] bool is_file(std::string_view robot) noexcept;

/// The robot of that name, or of that URDF file. It is read once and stays for the life of the program. The
/// error is one sentence: file, element, and what would be right. For start-up: allocates, reads files;
/// thread-safe.
[[nodiscard]] std::expected<const Robot*, std::string> find(std::string_view robot);

/// Keeps the robot of a URDF under a name: from now on find() gives it for that name, whatever is there. For
/// records, which carry the URDF. Earlier pointers stay valid. Otherwise like find().
[[nodiscard]] std::expected<const Robot*, std::string> keep(std::string_view name, std::string_view urdf);

/// The robot of a run, by its name and its description as the run's messages carry them: that of the
/// description, as of keep(). A shipped robot is the shipped one. Otherwise, and without a description, like
/// find().
[[nodiscard]] std::expected<const Robot*, std::string> of_run(std::string_view name, std::string_view urdf);

/// A robot from the text of a URDF; `name` is its name and begins the error. Its constants have no name.
[[nodiscard]] std::expected<Robot, std::string> parse(std::string_view name, std::string_view urdf);

}  // namespace stilt::robots
