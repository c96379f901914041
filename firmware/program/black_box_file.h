#pragma once

#include <expected>
#include <optional>
#include <string>

#include "firmware/program/controller_state.h"
#include "firmware/program/options.h"

namespace stilt::program {

/// The file of --black-box: the ticks around the fault with the hardest reaction. Of equal ones it is the
/// first, which is the cause of those that follow more often than not. A write that fails leaves the file as
/// it was. Files of earlier runs stay, nine of them: FILE.csv becomes FILE.1.csv before the first write of
/// this run. Housekeeping's. Without the option it does nothing.
class BlackBoxFile {
 public:
  /// A quarter of the black box is kept for what follows a fault.
  BlackBoxFile(const Options& options, ControllerState& state);

  /// Once the black box has frozen: writes it where it is harder than what the file holds, and lets it record
  /// again. Says so on standard error.
  void save();

  /// The torque loop has ended: also what it had no time to finish. Waits until the file is on the disk. The
  /// error, one sentence for the user, says that the fault with the hardest reaction is not in the file.
  [[nodiscard]] std::expected<void, std::string> finish();

 private:
  void write();

  const Options& options_;
  ControllerState& state_;
  bool earlier_kept_ = false;                               ///< files of earlier runs are out of the way
  std::optional<supervisor::Reaction> written_;             ///< the hardest in the file
  supervisor::Reaction lost_ = supervisor::Reaction::none;  ///< the hardest that could not be written
  std::string complaint_;                                   ///< about the one that is lost; empty: none is
};

}  // namespace stilt::program
