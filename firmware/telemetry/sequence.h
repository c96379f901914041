#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/telemetry/messages.h"

/// Lending memory of C++ to the C structures of messages, for as long as a write takes.
namespace stilt::telemetry {

/// The sequence is the vector's numbers.
template <class Sequence, class T>
void set_view(Sequence& sequence, std::vector<T>& numbers) noexcept {
  sequence._buffer = numbers.data();
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(numbers.size());
  sequence._release = false;
}

/// The string is the text.
inline void set_view(char*& string, std::string& text) noexcept { string = text.data(); }

/// The string is a constant, which Cyclone only reads.
inline void set_view(char*& string, const char* text) noexcept { string = const_cast<char*>(text); }

/// A sequence of strings.
class Texts {
 public:
  void add(std::string text) { texts_.push_back(std::move(text)); }
  void set_view_in(dds_sequence_string& sequence) {
    pointers_.clear();
    for (std::string& text : texts_) pointers_.push_back(text.data());
    set_view(sequence, pointers_);
  }

 private:
  std::vector<std::string> texts_;
  std::vector<char*> pointers_;
};

}  // namespace stilt::telemetry
