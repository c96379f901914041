#pragma once

#include <expected>
#include <functional>
#include <optional>
#include <string>

#include "firmware/commissioning/session.h"

/// Questions to the person beside the robot. Ordinary threads.
namespace stilt::commissioning {

/// The person, or a file of answers.
class Person {
 public:
  virtual ~Person() = default;
  virtual void ask(const std::string& question) = 0;
  /// The next line that was answered; nothing: not yet. Never waits.
  [[nodiscard]] virtual std::optional<std::string> answer() = 0;
  /// No answer will come any more.
  [[nodiscard]] virtual bool gone() const = 0;
  /// Whether a wrong answer may be given again: somebody types.
  [[nodiscard]] virtual bool patient() const = 0;
};

/// Why a command has no result.
struct CommandFailure {
  std::string sentence;
  bool bad_answer = false;  ///< the person's, not the robot's
};

/// Takes an answer, without blanks around it and in small letters. False: it is not an answer to the
/// question.
using TakeAnswer = std::function<bool(const std::string& answer)>;

/// Asks until `take` accepts an answer, or fails at the first wrong one of a person who is not patient. The
/// robot stays limp meanwhile.
/// @param each_tick  called after every tick, when given
[[nodiscard]] std::expected<void, CommandFailure> ask(Session& session, Person& person,
                                                      const std::string& question, const TakeAnswer& take,
                                                      const std::function<void()>& each_tick = {});

}  // namespace stilt::commissioning
