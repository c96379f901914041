#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "firmware/control_loop/tick_record.h"
#include "firmware/telemetry/messages.h"

/// Ticks as records and as the message that carries many of them.
namespace stilt::telemetry {

/// Most ticks in a message.
inline constexpr std::size_t kTicksPerBatch = 50;

/// Fills a message with one tick after the other. Ordinary threads.
class TickBatchBuilder {
 public:
  TickBatchBuilder();
  ~TickBatchBuilder();
  TickBatchBuilder(const TickBatchBuilder&) = delete;
  TickBatchBuilder& operator=(const TickBatchBuilder&) = delete;

  /// Whether this tick may be added: there is room, and it follows the last one.
  [[nodiscard]] bool takes(const control_loop::TickRecord& record) const noexcept;
  void add(const control_loop::TickRecord& record);
  void clear() noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return message().count; }

  /// The message; its numbers are valid until add() or clear().
  [[nodiscard]] const TickBatch& message() const noexcept;
  /// For run_id and drops.
  [[nodiscard]] TickBatch& message() noexcept;

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

/// Whether every sequence of a received message has the length that `count` asks for. Every number of an
/// enumeration must be one of its enumerators: anybody may send others, and names are looked up by them.
[[nodiscard]] bool well_formed(const TickBatch& batch) noexcept;

/// The record of a tick, bit for bit what TickBatchBuilder::add() was given.
/// @param index  0 to batch.count - 1 of a message that is well_formed()
[[nodiscard]] control_loop::TickRecord tick_record(const TickBatch& batch, std::size_t index) noexcept;

}  // namespace stilt::telemetry
