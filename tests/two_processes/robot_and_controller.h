#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/own_folder.h"
#include "tests/two_processes/process.h"

namespace stilt::two_processes {

/// `stilt robot` and `stiltd` on two loopback buses of their own, with a folder for their files, one of them
/// the run's token. They speak in the DDS domain of this process (tests/own_domain.h). With STILT_TEST_VCAN
/// in the environment the buses are vcan0 and vcan1 of the kernel (tests/realtime_vm/first_day.sh).
class RobotAndController {
 public:
  RobotAndController() = default;
  ~RobotAndController();

  /// Starts the robot and waits until it listens.
  void start_robot(const std::vector<std::string>& options);
  void start_controller(const std::vector<std::string>& options);
  /// stiltd selftest in the controller's place.
  void start_self_test(const std::vector<std::string>& options);
  /// Another of stiltd's commands there, with its own arguments.
  /// @param input  for its standard input; empty: that of the test
  void start_command(const std::vector<std::string>& command, const std::vector<std::string>& options,
                     const std::string& input = "");

  /// A report on the configuration there, which takes no option of a run.
  void start_report(const std::vector<std::string>& options);

  [[nodiscard]] Process& robot() { return *robot_; }
  [[nodiscard]] Process& controller() { return *controller_; }

  /// Ends the robot although a controller is connected, which its first signal waits for.
  void end_robot() const;

  /// Waits for both and expects them to end in time: nothing hangs.
  void expect_both_to_end();

  [[nodiscard]] nlohmann::json robot_json() const { return json("robot.json"); }
  [[nodiscard]] nlohmann::json controller_json() const { return json("controller.json"); }
  /// Name of a bus, 0 or 1.
  [[nodiscard]] std::string bus(std::size_t number) const;
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// What both printed, for messages.
  [[nodiscard]] std::string said() const;

 private:
  void start(std::vector<std::string> program, const std::vector<std::string>& options,
             const std::string& input = "");
  [[nodiscard]] nlohmann::json json(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& program,
                                               const std::vector<std::string>& options) const;

  tests::OwnFolder folder_;
  std::string bus_ = folder_.path().filename().string();  ///< a name that no other run has
  std::unique_ptr<Process> robot_, controller_;
};

/// A bound for hanging, generous on a busy machine, and for an emulated processor.
inline const double kLongestRun_s = std::getenv("STILT_TEST_VCAN") == nullptr ? 400.0 : 6000.0;

}  // namespace stilt::two_processes
