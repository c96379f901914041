#pragma once

#include <expected>
#include <optional>
#include <string>

#include "firmware/commissioning/jog_dialog.h"

namespace stilt::program {

/// The person at standard input, or a file of answers. Questions go to standard error.
class TerminalPerson final : public commissioning::Person {
 public:
  /// Reads the whole file, before a motor turns.
  /// @param file  empty: standard input. The error is one sentence for the user.
  [[nodiscard]] static std::expected<TerminalPerson, std::string> open(const std::string& file);

  void ask(const std::string& question) override;
  [[nodiscard]] std::optional<std::string> answer() override;
  [[nodiscard]] bool gone() const override { return ended_ && pending_.empty(); }
  [[nodiscard]] bool patient() const override { return patient_; }

 private:
  bool patient_ = false;  ///< somebody types
  bool ended_ = false;
  std::string pending_;  ///< read, and not taken yet
};

}  // namespace stilt::program
