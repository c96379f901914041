#pragma once

#include <array>
#include <optional>
#include <string>

#include "firmware/commissioning/calibrate.h"
#include "tests/firmware/commissioning/hanging_robot.h"

namespace stilt::commissioning::testing {

/// Does what calibrate asks for with the simulated robot's hands, and answers when it is done. What a jog
/// asks it answers as an Onlooker.
class Helper final : public Person {
 public:
  explicit Helper(HangingRobot& robot) : robot_(robot), onlooker_(robot) {}

  void ask(const std::string& question) override;
  [[nodiscard]] std::optional<std::string> answer() override;
  [[nodiscard]] bool gone() const override { return false; }
  [[nodiscard]] bool patient() const override { return false; }

  /// Share of the asked way to which joints are moved: less than 1, and a stop is not reached.
  double share_of_travel = 1.0;
  /// What it answers when it is asked how far a joint turned from its mark.
  std::string turned;
  /// Takes forward for backward: moves hips to the angle of the other sign.
  bool exchanges_ways = false;
  /// Where the torso hangs at rest, once calibrate comes to it.
  double torso_rest_rad = 0.0;
  /// How long it holds the thigh before it rocks the torso.
  double waits_to_rock_s = 0.0;

 private:
  void move_joint(const std::string& question);
  void rock();

  HangingRobot& robot_;
  Onlooker onlooker_;
  bool looks_ = false;
  bool measures_ = false;
  bool rocks_ = false;
  std::int64_t asked_ns_ = 0;
  std::int64_t begins_ns_ = 0;  ///< to rock
  std::int64_t done_ns_ = 0;
};

/// That with the hardware of the commands' configuration and AMBER-3M's travel.
[[nodiscard]] CalibrationRequest calibration_request(const HangingRobot& robot, Reference reference);

}  // namespace stilt::commissioning::testing
