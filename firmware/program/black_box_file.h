#pragma once

#include <expected>
#include <string>

#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// The file of --black-box: the ticks around the fault with the hardest reaction, of equal ones the newest.
/// Housekeeping's. Without the option it does nothing.
class BlackBoxFile {
 public:
  /// A quarter of the black box is kept for what follows a fault.
  BlackBoxFile(const Options& options, ControllerState& state);

  /// Once the black box has frozen: writes it unless the file holds something harder, and lets it record
  /// again. Says so on standard error.
  void save();

  /// The torque loop has ended: also what it had no time to finish. The error, one sentence for the user,
  /// says that the last black box to be written is not in the file.
  [[nodiscard]] std::expected<void, std::string> finish();

 private:
  void write();

  const Options& options_;
  ControllerState& state_;
  supervisor::Reaction written_ = supervisor::Reaction::none;  ///< the hardest in the file
  std::string complaint_;                                      ///< about the last write; empty: it is there
};

}  // namespace stilt::program
