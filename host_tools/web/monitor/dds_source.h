#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_tools/telemetry/commander.h"
#include "host_tools/telemetry/listener.h"
#include "host_tools/web/monitor/message_decoder.h"
#include "host_tools/web/monitor/sample_source.h"

namespace stilt::monitor {

/// Samples of the live robot from the network.
class DdsSource final : public SampleSource {
 public:
  /// @param token  token of the run that is shown; empty: the token in the file that stiltd names, when it is
  ///               readable. For other runs their file comes first.
  /// @param warn   gets one sentence for the user when the run that is shown has no known token.
  ///               Throws std::runtime_error with one sentence when the network cannot be joined.
  DdsSource(
      const telemetry::Network& network, std::string token,
      std::function<void(const std::string&)> warn = [](const std::string&) {});

  void poll(SampleSink& sink) override;
  void command(const Command& command) override;
  [[nodiscard]] std::vector<SendingRun> talking() const override;
  void forget(std::uint64_t commander) override { asked_.erase(commander); }
  void choose(const std::string& run_id) override { chosen_ = run_id; }
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] bool live() const override { return true; }
  [[nodiscard]] bool has_token() const override { return !active_token_.empty(); }
  [[nodiscard]] std::uint64_t of_others() const override { return decoder_.of_others(); }
  [[nodiscard]] std::string refused() const override { return decoder_.refused(); }

 private:
  /// A command without reply.
  struct Asked {
    std::uint64_t number;  ///< on the wire
    std::uint64_t run_id;
    std::uint32_t sequence;
    std::string token;     ///< that the command proves
    bool refused = false;  ///< by a reply without proof of it
  };

  void take(const telemetry::Sample& message, SampleSink& sink);
  void answer(const telemetry::CommandReply& reply, SampleSink& sink);
  void learn_token();
  [[nodiscard]] std::string token_of(const KnownRun& run) const;
  [[nodiscard]] std::vector<std::string> tokens_for(const KnownRun& run, const std::string& given,
                                                    bool with_known) const;
  [[nodiscard]] std::vector<std::string> tokens_of(const Command& command) const;
  void send(const Command& command, const std::string& token);
  void stop_others(const Command& command);

  telemetry::Network network_;
  telemetry::Participant participant_;
  host_telemetry::Listener listener_;
  host_telemetry::Commander commander_;
  MessageDecoder decoder_;
  std::string token_;  ///< given by the user
  std::function<void(const std::string&)> warn_;
  std::string active_token_;                          ///< that token, or the one in the file
  std::uint64_t run_id_ = 0;                          ///< of active_token_
  std::string chosen_;                                ///< run to show from the next poll on; empty: no change
  std::map<std::uint64_t, std::deque<Asked>> asked_;  ///< of each sender, oldest first
};

}  // namespace stilt::monitor
