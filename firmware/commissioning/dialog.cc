#include "firmware/commissioning/dialog.h"

#include <algorithm>
#include <cctype>

namespace stilt::commissioning {
namespace {

std::string trimmed(std::string text) {
  const auto blank = [](unsigned char letter) { return std::isspace(letter) != 0; };
  text.erase(text.begin(), std::ranges::find_if_not(text, blank));
  while (!text.empty() && blank(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::ranges::transform(text, text.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return text;
}

}  // namespace

std::expected<void, CommandFailure> ask(Session& session, Person& person, const std::string& question,
                                        const TakeAnswer& take, const std::function<void()>& each_tick) {
  person.ask(question);
  while (!session.stopped()) {
    session.tick();
    if (each_tick) each_tick();
    const std::optional<std::string> answer = person.answer();
    if (!answer && person.gone()) return std::unexpected(CommandFailure{"no answer to: " + question, true});
    if (!answer) continue;
    if (take(trimmed(*answer))) return {};
    if (!person.patient()) {
      return std::unexpected(CommandFailure{"\"" + *answer + "\" is no answer to: " + question, true});
    }
    person.ask("\"" + *answer + "\" is no answer here.\n" + question);
  }
  return std::unexpected(CommandFailure{"stopped", false});
}

}  // namespace stilt::commissioning
