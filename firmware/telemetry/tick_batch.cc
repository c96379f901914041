#include "firmware/telemetry/tick_batch.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "firmware/control_loop/tick_fields.h"
#include "mpc_core/sqp/solve_status_names.h"

namespace stilt::telemetry {
namespace {

using control_loop::kTickFieldCount;
using control_loop::TickRecord;

/// Number on the wire of a value.
template <class Value>
auto number_of(const Value& value) noexcept {
  if constexpr (std::is_same_v<Value, supervisor::FaultSet>) {
    return value.bits();
  } else if constexpr (std::is_enum_v<Value> || std::is_same_v<Value, bool>) {
    return static_cast<std::uint8_t>(value);
  } else {
    return value;
  }
}

/// Type of a field's numbers in the message.
template <class Field>
using WireOf = std::conditional_t<std::is_void_v<typename Field::Wire>,
                                  decltype(number_of(
                                      std::declval<const Field&>().at(std::declval<const TickRecord&>()))),
                                  typename Field::Wire>;

/// Number of enumerators of each enumeration in the table of fields.
template <class Enumeration>
constexpr std::size_t kEnumerators = 0;
template <>
constexpr std::size_t kEnumerators<hal::JointBusStatus> = hal::kJointBusStatuses;
template <>
constexpr std::size_t kEnumerators<hal::DriverState> = hal::kDriverStates;
template <>
constexpr std::size_t kEnumerators<hal::DriverFault> = hal::kDriverFaults;
template <>
constexpr std::size_t kEnumerators<hal::EmergencyStopState> = hal::kEmergencyStopStates;
template <>
constexpr std::size_t kEnumerators<hal::bring_up::Stage> = hal::bring_up::kStages;
template <>
constexpr std::size_t kEnumerators<hal::bring_up::Failure> = hal::bring_up::kFailures;
template <>
constexpr std::size_t kEnumerators<hal::bring_up::Setting> = hal::bring_up::kSettings;
template <>
constexpr std::size_t kEnumerators<supervisor::RequestKind> = supervisor::kRequestKinds;
template <>
constexpr std::size_t kEnumerators<supervisor::Action> = supervisor::kActions;
template <>
constexpr std::size_t kEnumerators<supervisor::State> = supervisor::kStates;
template <>
constexpr std::size_t kEnumerators<supervisor::FallbackLevel> = supervisor::kFallbackLevels;
template <>
constexpr std::size_t kEnumerators<supervisor::Reaction> = supervisor::kReactions;
template <>
constexpr std::size_t kEnumerators<sqp::SolveStatus> = sqp::kSolveStatusNames.size();
template <>
constexpr std::size_t kEnumerators<gait::GaitKind> = static_cast<std::size_t>(gait::GaitKind::walk) + 1;

/// Whether every number of a field's sequence is one that the field can have.
template <class Field>
bool all_known(const dds_sequence_t& sequence) noexcept {
  using Value =
      std::remove_cvref_t<decltype(std::declval<const Field&>().at(std::declval<const TickRecord&>()))>;
  if constexpr (std::is_enum_v<Value>) {
    static_assert(kEnumerators<Value> > 0 && sizeof(Value) == 1, "a row above");
    const std::span numbers(sequence._buffer, sequence._length);
    return std::ranges::all_of(numbers, [](std::uint8_t number) { return number < kEnumerators<Value>; });
  }
  return true;
}

// The sequences of the message have the order of the table, and memory of one layout whatever they hold: that
// of dds_sequence_t. A test compares names, order and types with the IDL.
constexpr std::size_t kFirstSequence = offsetof(TickBatch, time_ns);
static_assert(sizeof(TickBatch) == kFirstSequence + kTickFieldCount * sizeof(dds_sequence_t));
static_assert(sizeof(TickBatch::time_ns) == sizeof(dds_sequence_t));

/// Calls visit(field, sequence) for every field; the message keeps what becomes of the sequence.
template <class Batch, class Visit>
void for_each_sequence(Batch& batch, Visit&& visit) {
  using Byte = std::conditional_t<std::is_const_v<Batch>, const std::byte, std::byte>;
  Byte* place = reinterpret_cast<Byte*>(&batch) + kFirstSequence;
  control_loop::for_each_tick_field([&](const auto& field) {
    dds_sequence_t sequence;
    std::memcpy(&sequence, place, sizeof sequence);
    visit(field, sequence);
    if constexpr (!std::is_const_v<Batch>) std::memcpy(place, &sequence, sizeof sequence);
    place += sizeof sequence;
  });
}

template <class Value, class Number>
void set_value(Value& value, Number number) noexcept {
  if constexpr (std::is_same_v<Value, supervisor::FaultSet>) {
    value = supervisor::FaultSet(number);
  } else {
    value = static_cast<Value>(number);
  }
}

}  // namespace

/// The message and the numbers of its sequences.
struct TickBatchBuilder::Memory {
  TickBatch message{};
  std::vector<std::unique_ptr<std::uint8_t[]>> columns;
};

TickBatchBuilder::TickBatchBuilder() : memory_(std::make_unique<Memory>()) {
  for_each_sequence(memory_->message, [this]<class Field>(const Field& field, dds_sequence_t& sequence) {
    const std::size_t numbers = field.count() * kTicksPerBatch;
    memory_->columns.push_back(std::make_unique<std::uint8_t[]>(numbers * sizeof(WireOf<Field>)));
    sequence._buffer = memory_->columns.back().get();
    sequence._maximum = static_cast<std::uint32_t>(numbers);
  });
}

TickBatchBuilder::~TickBatchBuilder() = default;

const TickBatch& TickBatchBuilder::message() const noexcept { return memory_->message; }
TickBatch& TickBatchBuilder::message() noexcept { return memory_->message; }

bool TickBatchBuilder::takes(const TickRecord& record) const noexcept {
  const TickBatch& batch = memory_->message;
  return batch.count == 0 || (batch.count < kTicksPerBatch && record.tick == batch.first_tick + batch.count);
}

void TickBatchBuilder::add(const TickRecord& record) {
  TickBatch& batch = memory_->message;
  if (batch.count == 0) batch.first_tick = record.tick;
  for_each_sequence(batch, [&]<class Field>(const Field& field, dds_sequence_t& sequence) {
    for (std::size_t i = 0; i < field.count(); ++i) {
      const auto number = static_cast<WireOf<Field>>(number_of(field.at(record, i)));
      std::memcpy(sequence._buffer + sequence._length++ * sizeof number, &number, sizeof number);
    }
  });
  ++batch.count;
}

void TickBatchBuilder::clear() noexcept {
  for_each_sequence(memory_->message, [](const auto&, dds_sequence_t& sequence) { sequence._length = 0; });
  memory_->message.count = 0;
}

bool well_formed(const TickBatch& batch) noexcept {
  bool right = true;
  for_each_sequence(batch, [&]<class Field>(const Field& field, const dds_sequence_t& sequence) {
    right = right && sequence._length == field.count() * batch.count;
    right = right && all_known<Field>(sequence);
  });
  return right;
}

TickRecord tick_record(const TickBatch& batch, std::size_t index) noexcept {
  TickRecord record;
  record.tick = batch.first_tick + index;
  for_each_sequence(batch, [&]<class Field>(const Field& field, const dds_sequence_t& sequence) {
    for (std::size_t i = 0; i < field.count(); ++i) {
      WireOf<Field> number;
      std::memcpy(&number, sequence._buffer + (index * field.count() + i) * sizeof number, sizeof number);
      set_value(field.at(record, i), number);
    }
  });
  return record;
}

}  // namespace stilt::telemetry
