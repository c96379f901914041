#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/telemetry/messages.h"

/// Samples as the bytes they are on the wire, and as structures. Needs no network; allocates: ordinary
/// threads.
namespace stilt::telemetry {

/// A sample as it travels: four bytes that name the encoding (00 01 00 00: little-endian CDR), then the
/// fields.
using Cdr = std::vector<std::byte>;

namespace internal {
[[nodiscard]] Cdr encode(const dds_topic_descriptor_t& type, const void* message);
/// False: the bytes are not a message of this type, which is left as it was.
[[nodiscard]] bool decode(const dds_topic_descriptor_t& type, std::span<const std::byte> cdr, void* message);
struct Free {
  const dds_topic_descriptor_t* type;
  void operator()(void* message) const noexcept { dds_sample_free(message, type, DDS_FREE_ALL); }
};
}  // namespace internal

/// A message that owns its strings and sequences.
template <class T>
using Owned = std::unique_ptr<T, internal::Free>;

/// An empty message.
template <class T>
[[nodiscard]] Owned<T> make_message() {
  return Owned<T>(static_cast<T*>(dds_alloc(sizeof(T))), internal::Free{&descriptor<T>()});
}

/// The bytes of a message. Strings must not be null.
template <class T>
[[nodiscard]] Cdr encode(const T& message) {
  return internal::encode(descriptor<T>(), &message);
}

/// The message of the bytes; null when they are not one.
template <class T>
[[nodiscard]] Owned<T> decode(std::span<const std::byte> cdr) {
  Owned<T> message = make_message<T>();
  if (!internal::decode(descriptor<T>(), cdr, message.get())) message.reset();
  return message;
}

/// The numbers of a sequence.
template <class Sequence>
[[nodiscard]] auto span_of(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

}  // namespace stilt::telemetry
