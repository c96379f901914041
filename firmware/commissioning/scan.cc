#include "firmware/commissioning/scan.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "firmware/commissioning/formatted.h"
#include "firmware/configuration/driver_of.h"
#include "firmware/configuration/protocol_name.h"
#include "firmware/control_loop/joint_names.h"
#include "hal/robot/driver_scan.h"
#include "hal/robot/driver_settings.h"
#include "hal/robot/wiring_load.h"

namespace stilt::commissioning {
namespace {

constexpr std::int64_t kStep_ns = 1'000'000;
constexpr int kListenSteps = 200;
constexpr int kTries = 3;  ///< of a driver of the configuration
/// More answers than questions, after two rounds: one more may be a report that comes more rarely than once
/// while listening.
constexpr int kSurplus = 2;
constexpr double kTooOften = 1.5;  ///< times the rate of a driver that reports by its own clock

/// How a driver is asked.
struct Patience {
  int answer_steps;    ///< after each question
  bool all_questions;  ///< also when the first one was not answered
};
constexpr Patience kForExpected{10, true};
constexpr Patience kForOthers{3, false};

using FrameKey = std::pair<std::uint32_t, bool>;  ///< identifier, extended

struct Candidate {
  hal::JointDriver driver;
  ScannedNode node;
  std::optional<hal::SettingReader> settings;
  std::vector<hal::ReadSetting> watchdog_keys;  ///< with the section of the configuration
  int questions = 0;                            ///< without those that its own reports would answer
  int answers = 0;                              ///< to those
  std::set<FrameKey> reports = {};              ///< that came before it was asked
};

ScannedNode node_of(const hal::JointDriver& driver, configuration::DriverProtocol protocol) {
  ScannedNode node;
  node.protocol = configuration::name(protocol);
  node.id = hal::scan_id(driver);
  return node;
}

/// One bus: its nodes, and what was received.
class BusScan {
 public:
  BusScan(const configuration::HardwareParameters& hardware,
          const std::array<hal::bring_up::Options, hal::kJoints>& wanted, std::size_t bus,
          hal::FrameBus& frames, hal::Clock& clock, const std::atomic<bool>& stop)
      : wiring_(configuration::robot_wiring(hardware)),
        sensor_rate_hz_(hardware.torso_sensor.rate_hz),
        frames_(frames),
        clock_(clock),
        stop_(stop) {
    result_.name = configuration::bus_names(hardware)[bus];
    for (std::size_t joint = 0; joint < hal::kJoints; ++joint) {
      if (wiring_.joints[joint].bus == bus) expect(hardware, joint, wanted[joint]);
    }
    if (wiring_.channel_bus != bus) wiring_.channel_count = 0;
    if (wiring_.pitch_encoder_bus != bus) wiring_.pitch_encoder.reset();
  }

  ScannedBus run() {
    listen();
    sort_unasked();
    const hal::BusCounters before = frames_.counters();
    ask_expected();
    result_.acknowledged = acknowledged_since(before);
    for (Candidate& candidate : expected_) {
      if (candidate.node.found.answered) read_settings(candidate);
    }
    if (wiring_.pitch_encoder && !stop_) start_encoder();
    if (result_.acknowledged && protocols_.size() == 1) ask_others();
    if (!result_.acknowledged) result_.bus_errors = 0;
    result_.off = frames_.health() == hal::BusHealth::off;
    for (Candidate& candidate : expected_) result_.expected.push_back(finished(candidate));
    return std::move(result_);
  }

 private:
  void expect(const configuration::HardwareParameters& hardware, std::size_t joint,
              const hal::bring_up::Options& wanted) {
    const hal::JointDriver& driver = wiring_.joints[joint].driver;
    const auto protocol = configuration::driver_of(hardware, joint).protocol;
    protocols_.insert(protocol);
    Candidate candidate{driver, node_of(driver, protocol), hal::make_setting_reader(driver, wanted),
                        hal::watchdog_keys(driver, wanted)};
    for (hal::ReadSetting& key : candidate.watchdog_keys) {
      key.name = std::string(control_loop::driver_section(joint)) + "." + key.name;
    }
    candidate.node.joint = joint;
    if (std::holds_alternative<hal::mit::MitDriver>(driver)) {
      candidate.node.expected_reply_id = hardware.joint[joint].reply_id;
    }
    expected_.push_back(std::move(candidate));
  }

  ScannedNode finished(const Candidate& candidate) const {
    ScannedNode node = candidate.node;
    node.several = several(candidate);
    if (node.found.answered) node.undecoded.reset();
    if (!result_.acknowledged) node.bus_errors = 0;
    node.settings.insert(node.settings.end(), candidate.watchdog_keys.begin(), candidate.watchdog_keys.end());
    if (node.found.version) node.firmware = hal::version_text(candidate.driver, *node.found.version);
    return node;
  }

  /// What came before counts for no rate: while other buses were scanned, or this program stood still.
  void listen() {
    std::int64_t began_ns = 0;
    do {
      began_ns = clock_.now_ns();
      receive([](const hal::CanFrame&) {});
    } while (clock_.now_ns() - began_ns > kStep_ns && !stop_);
    for (int step = 0; step < kListenSteps && !stop_; ++step) take_step(nullptr);
    listened_s_ = static_cast<double>(std::max(clock_.now_ns() - began_ns, kStep_ns)) * 1e-9;
    listening_ = false;
  }

  /// Drivers whose answers collide make the controller of the bus passive, too.
  [[nodiscard]] bool acknowledged_since(const hal::BusCounters& before) const {
    const hal::BusCounters& after = frames_.counters();
    const bool stuck = after.withheld != before.withheld || after.dropped_full != before.dropped_full ||
                       frames_.health() >= hal::BusHealth::passive;
    return !stuck || std::ranges::any_of(
                         expected_, [](const Candidate& candidate) { return candidate.node.found.answered; });
  }

  template <typename Take>
  void receive(Take take) {
    std::array<hal::CanFrame, hal::kMaximumBatch> batch;
    hal::ReceiveResult received;
    do {
      received = frames_.receive(batch);
      result_.gone = result_.gone || received.status == hal::BusStatus::disconnected;
      for (const hal::CanFrame& frame : std::span(batch).first(received.received)) take(frame);
    } while (received.status == hal::BusStatus::more);
  }

  void take_step(Candidate* asked) {
    static_cast<void>(clock_.sleep_until(clock_.now_ns() + kStep_ns));
    receive([this, asked](const hal::CanFrame& frame) { take(frame, asked); });
  }

  void take(const hal::CanFrame& frame, Candidate* asked) {
    const FrameKey key{frame.id, frame.extended};
    if (listening_) note_unasked(key, frame);
    if (reads_ != nullptr) {
      answered_ = hal::visit_driver(*reads_, [&](auto& any) { return any.take(frame); }) || answered_;
    }
    if (encoder_ && encoder_->take(clock_.now_ns(), frame, position_) == hal::DecodeStatus::ok) ++positions_;
    for (Candidate& candidate : expected_) {
      if (hal::sends_unasked(candidate.driver) &&
          hal::take_scan(candidate.driver, frame, candidate.node.found)) {
        of_drivers_.insert(key);
        if (listening_) candidate.reports.insert(key);
        if (&candidate == asked && !unasked_.contains(key)) ++candidate.answers;
        return;
      }
    }
    if (asked == nullptr || of_sensor(key)) return;
    // What came before anybody was asked is the answer of no driver that only answers.
    if (!hal::sends_unasked(asked->driver) && unasked_.contains(key)) return;
    if (!hal::take_scan(asked->driver, frame, asked->node.found)) return note_undecoded(key, frame, *asked);
    of_drivers_.insert(key);
    ++asked->answers;
  }

  /// A late answer of another driver of the configuration is none of these.
  void note_undecoded(const FrameKey& key, const hal::CanFrame& frame, Candidate& asked) const {
    const auto decodes = [&frame](const Candidate& candidate) {
      hal::ScannedDriver ignored;
      return hal::take_scan(candidate.driver, frame, ignored);
    };
    if (!asked.node.joint || unasked_.contains(key) || std::ranges::any_of(expected_, decodes)) return;
    const auto ids = hal::visit_driver(asked.driver, [](const auto& any) { return receive_ids(any); });
    if (std::ranges::any_of(ids, [&key](const auto& id) { return FrameKey{id.id, id.extended} == key; }))
      asked.node.undecoded = {frame.id, frame.length};
  }

  void note_unasked(const FrameKey& key, const hal::CanFrame& frame) {
    ++unasked_[key];
    newest_unasked_[key] = frame;
    for (Candidate& candidate : expected_) {
      hal::visit_driver(*candidate.settings, [&](auto& any) { any.listen(frame); });
    }
  }

  /// Asks for one setting after the other; what is not answered after some tries is left out.
  void read_settings(Candidate& candidate) {
    constexpr int kSettingTries = 5;
    reads_ = &*candidate.settings;
    for (int lost = 0; !stop_; lost = answered_ ? 0 : lost + 1) {
      const bool give_up = lost == kSettingTries;
      if (give_up) lost = 0;
      const auto question =
          hal::visit_driver(*reads_, [&](auto& any) { return any.next(lost > 0, give_up); });
      if (!question) break;
      answered_ = false;
      static_cast<void>(frames_.send(std::span(&*question, 1)));  // what does not leave is not answered
      for (int step = 0; step < kForExpected.answer_steps && !answered_ && !stop_; ++step) take_step(nullptr);
    }
    const hal::SettingReader& read = *std::exchange(reads_, nullptr);
    if (stop_) return;  // what was not asked is not wrong
    candidate.node.settings =
        hal::visit_driver(read, [this](const auto& any) { return any.settings(listened_s_); });
  }

  [[nodiscard]] std::span<const hal::ChannelRow> channels() const {
    return std::span(wiring_.channels).first(wiring_.channel_count);
  }

  [[nodiscard]] bool of_sensor(const FrameKey& key) const {
    return std::ranges::any_of(
        channels(), [&key](const hal::ChannelRow& row) { return FrameKey{row.id, row.extended} == key; });
  }

  /// Frames that came unasked are those of the torso sensor, of drivers, or unknown.
  void sort_unasked() {
    std::set<FrameKey> expected;
    for (const hal::ChannelRow& row : channels()) expected.emplace(row.id, row.extended);
    if (wiring_.pitch_encoder) {
      for (const hal::FrameId& frame : hal::canopen::receive_ids(*wiring_.pitch_encoder))
        of_drivers_.emplace(frame.id, frame.extended);
    }
    for (const FrameKey& key : expected) {
      const auto found = unasked_.find(key);
      const int count = found == unasked_.end() ? 0 : found->second;
      result_.torso_sensor.push_back({key.first, key.second, count / listened_s_, sensor_rate_hz_});
    }
    for (const auto& [key, count] : unasked_) {
      if (expected.contains(key) || of_drivers_.contains(key)) continue;
      result_.unknown.push_back({key.first, key.second, count / listened_s_});
    }
  }

  /// An encoder on CANopen is asked and started as the controller does it: it moves nothing.
  void start_encoder() {
    constexpr int kLongest = 500, kCounted = 100;
    const hal::canopen::Encoder& encoder = *wiring_.pitch_encoder;
    encoder_.emplace(encoder, 1);
    for (int step = 0; step < kLongest && positions_ == 0 && !stop_; ++step) step_encoder();
    if (positions_ > 0) {
      positions_ = 0;
      for (int step = 0; step < kCounted && !stop_; ++step) step_encoder();
    }
    result_.torso_sensor.push_back(
        {hal::canopen::tpdo1_id(encoder.node), false, positions_ / (kCounted * kStep_ns * 1e-9)});
    result_.torso_trouble = sentence(encoder_->trouble(), encoder);
    encoder_.reset();
  }

  void step_encoder() {
    if (const auto frame = encoder_->step(clock_.now_ns()))
      static_cast<void>(frames_.send(std::span(&*frame, 1)));  // what does not leave is not answered
    take_step(nullptr);
  }

  /// A driver that there is nothing to ask has reported by itself. Errors of the bus count where it does not
  /// answer. A controller that recovers reports that, too: it is active then.
  void ask(Candidate& candidate, const Patience& patience) {
    result_.asked.insert(candidate.node.id);
    const std::vector<hal::CanFrame> questions = hal::scan_frames(candidate.driver);
    if (questions.empty()) {
      for (const auto& [key, frame] : newest_unasked_) take(frame, &candidate);
    }
    const std::uint64_t errors = frames_.counters().error_frames;
    for (const hal::CanFrame& question : questions) {
      if (!question.remote || !unasked_.contains({question.id, question.extended})) ++candidate.questions;
      static_cast<void>(frames_.send(std::span(&question, 1)));  // what does not leave is not answered
      for (int step = 0; step < patience.answer_steps && !stop_; ++step) take_step(&candidate);
      if (!patience.all_questions && !candidate.node.found.answered) break;
    }
    if (candidate.node.found.answered || frames_.health() == hal::BusHealth::active) return;
    candidate.node.bus_errors += frames_.counters().error_frames - errors;
    result_.bus_errors += frames_.counters().error_frames - errors;
  }

  void ask_expected() {
    for (Candidate& candidate : expected_) {
      for (int attempt = 0; attempt < kTries && !stop_; ++attempt) {
        ask(candidate, kForExpected);
        if (candidate.node.found.answered) break;
      }
      if (candidate.answers > candidate.questions && !stop_) ask(candidate, kForExpected);
    }
  }

  /// Several drivers with one identifier all follow its commands. Their answers may be late, but one driver
  /// never gives more than it was asked for.
  [[nodiscard]] std::string several(const Candidate& candidate) const {
    if (candidate.answers >= candidate.questions + kSurplus)
      return formatted("%d answers to %d questions", candidate.answers, candidate.questions);
    const double own_hz =
        hal::visit_driver(candidate.driver, [](const auto& any) { return report_rate_hz(any); });
    for (const FrameKey& key : candidate.reports) {
      const double rate_hz = unasked_.at(key) / listened_s_;
      if (rate_hz > kTooOften * own_hz)
        return formatted("%.0f reports per second, and one has %g", rate_hz, own_hz);
    }
    return "";
  }

  void ask_others() {
    for (const hal::JointDriver& driver : hal::scan_others(expected_.front().driver)) {
      if (stop_) return;
      if (is_expected(driver) || uses_sensor_identifier(driver)) continue;
      Candidate candidate{driver, node_of(driver, *protocols_.begin()), std::nullopt, {}};
      ask(candidate, kForOthers);
      if (!candidate.node.found.answered) continue;
      std::erase_if(result_.unknown, [this](const ScannedFrames& frames) {
        return of_drivers_.contains({frames.id, frames.extended});
      });
      result_.unexpected.push_back(finished(candidate));
    }
    result_.asked_others = !stop_;
  }

  [[nodiscard]] bool is_expected(const hal::JointDriver& driver) const {
    return std::ranges::any_of(expected_, [&driver](const Candidate& candidate) {
      return candidate.node.id == hal::scan_id(driver);
    });
  }

  [[nodiscard]] bool uses_sensor_identifier(const hal::JointDriver& driver) const {
    const hal::NodeIdentifiers node = hal::identifiers(driver);
    if (wiring_.pitch_encoder &&
        !hal::collisions(hal::canopen::identifiers(*wiring_.pitch_encoder), node).empty())
      return true;
    return std::ranges::any_of(channels(), [&node](const hal::ChannelRow& row) {
      return !hal::collisions(hal::identifiers(row), node).empty();
    });
  }

  hal::RobotWiring wiring_;
  double sensor_rate_hz_;
  hal::FrameBus& frames_;
  hal::Clock& clock_;
  const std::atomic<bool>& stop_;
  ScannedBus result_;
  std::vector<Candidate> expected_;
  std::set<configuration::DriverProtocol> protocols_;
  std::map<FrameKey, int> unasked_;
  std::map<FrameKey, hal::CanFrame> newest_unasked_;
  std::set<FrameKey> of_drivers_;  ///< and of an encoder on CANopen
  std::optional<hal::canopen::EncoderReader> encoder_;
  hal::canopen::EncoderPosition position_;
  int positions_ = 0;
  bool listening_ = true;
  double listened_s_ = 0;
  hal::SettingReader* reads_ = nullptr;  ///< at work
  bool answered_ = false;                ///< its question
};

}  // namespace

bool ScanResult::complete() const noexcept {
  return !stopped && serial_sensor_trouble.empty() && std::ranges::all_of(buses, [](const ScannedBus& bus) {
    return !bus.gone && !bus.off && bus.bus_errors == 0 && bus.torso_trouble.empty() &&
           std::ranges::all_of(bus.expected, &ScannedNode::good) &&
           std::ranges::all_of(bus.torso_sensor, &ScannedFrames::well) && bus.unexpected.empty() &&
           bus.unknown.empty();
  });
}

ScanResult scan(const configuration::HardwareParameters& hardware,
                const std::array<hal::bring_up::Options, hal::kJoints>& wanted,
                std::span<hal::FrameBus* const> buses, hal::Clock& clock, const std::atomic<bool>& stop) {
  ScanResult result;
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    result.buses.push_back(BusScan(hardware, wanted, bus, *buses[bus], clock, stop).run());
  }
  result.stopped = stop;
  return result;
}

}  // namespace stilt::commissioning
