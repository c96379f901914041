#include "host_tools/recording/record/tick_ledger.h"

namespace stilt::record {
namespace {

constexpr std::size_t kGapsNamed = 5;

std::string range(std::uint64_t first, std::uint64_t end) {
  return std::to_string(first) + (end - first > 1 ? " to " + std::to_string(end - 1) : "");
}

}  // namespace

void TickLedger::add(std::uint64_t first, std::uint64_t count) {
  if (first + count <= next_) return;
  if (first > next_) gaps_.push_back({next_, first});
  count_ += first + count - (first > next_ ? first : next_);
  next_ = first + count;
}

std::string TickLedger::text() const { return text(gaps_); }

std::string TickLedger::text_of_breaks() const {
  const bool begins_late = !gaps_.empty() && gaps_.front().first == 0;
  return text(std::span(gaps_).subspan(begins_late ? 1 : 0));
}

std::string TickLedger::text(std::span<const Gap> gaps) const {
  if (empty()) return "no ticks";
  const std::uint64_t begin = gaps_.empty() || gaps_.front().first != 0 ? 0 : gaps_.front().end;
  std::string text = "ticks " + range(begin, next_) + ", ";
  if (gaps.empty()) return text + "none missing";
  text += "missing: ";
  for (std::size_t i = 0; i < gaps.size() && i < kGapsNamed; ++i) {
    text += (i > 0 ? ", " : "") + range(gaps[i].first, gaps[i].end);
  }
  if (gaps.size() > kGapsNamed) text += " and " + std::to_string(gaps.size() - kGapsNamed) + " more gaps";
  return text;
}

}  // namespace stilt::record
