#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/experiments/walk_case.h"

/// Robots and worlds that differ at random from those that the controller assumes.
namespace stilt::experiments {

/// What a random quantity changes in a walk.
enum class Changes {
  plant,         ///< the option of the plant of the quantity's name
  plan_delay,    ///< timing.plan_delay_s
  sensor_noise,  ///< the factor on the sensor noise
  push_phase     ///< the start of the push, steps after the first lift-off at or after `settled_s`
};

/// A quantity that is drawn anew for each robot, uniform in its range, with four significant digits.
struct RandomQuantity {
  std::string name;  ///< of the option of the plant, or another word
  std::string words, unit;
  double low = 0.0, high = 0.0;
  std::optional<double>
      nominal;  ///< assumed by the controller; nothing: it assumes no value, or has the true one
  Changes changes = Changes::plant;
  bool ends_only = false;  ///< one of the two ends, nothing between
};

/// Mass, inertia and centre of mass of each link; armature, Coulomb friction and torque limit of the joints.
/// Noise, bias and mounting of the sensors; delay of the plan; friction, slope and a step of the ground;
/// start of the push. `torso_com_m`: two heights of the torso's centre of mass to choose from, the nominal
/// one first; nothing: the height of the robot.
[[nodiscard]] std::vector<RandomQuantity> random_quantities(
    std::optional<std::pair<double, double>> torso_com_m);

/// Combinations of the quantities that matter together; not drawn themselves. The slope of the ground as the
/// torso sensor reads it: slope less the bias of the pitch.
[[nodiscard]] std::vector<RandomQuantity> combined_quantities();

/// The quantities as text, one per line, for a hash of what results depend on.
[[nodiscard]] std::string ranges_text(const std::vector<RandomQuantity>& quantities);

/// Seed of one robot of an experiment: the same on every machine.
[[nodiscard]] std::uint32_t robot_seed(std::uint32_t experiment_seed, int run);

/// The values of one robot, in the order of the quantities. They depend on the seed alone.
[[nodiscard]] std::vector<double> drawn_values(const std::vector<RandomQuantity>& quantities,
                                               std::uint32_t seed);

/// Times that place the push at a phase of the step.
struct PushTiming {
  double settled_s = 4.2;    ///< earliest start of the push
  double step_time_s = 0.3;  ///< step time of the gait
  double duration_s = 1.0;   ///< of the push
  double recovery_s = 4.5;   ///< time after the latest end of the push
};

/// Changes the walk to that of a robot of these values, with push and duration; its force is left as it is.
/// Values become text as in an option of `stilt sim`, so that an option repeats them exactly.
void apply_values(const std::vector<RandomQuantity>& quantities, const std::vector<double>& values,
                  const PushTiming& timing, WalkCase& walk);

}  // namespace stilt::experiments
