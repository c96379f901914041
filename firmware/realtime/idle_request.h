#pragma once

#include <string>

namespace stilt::realtime {

/// Keeps all processors from idle states that are slow to leave, as long as it lives. The kernel keeps the
/// request (PM QoS, Documentation/power/pm_qos_interface.rst) while /dev/cpu_dma_latency is open. Start-up
/// only.
class IdleRequest {
 public:
  IdleRequest() = default;
  /// @param exit_max_s  longest time that a processor may take to leave an idle state; whole microseconds
  /// @param root        where /dev is looked for, for tests
  explicit IdleRequest(double exit_max_s, const std::string& root = "");
  IdleRequest(IdleRequest&& other) noexcept;
  IdleRequest& operator=(IdleRequest&& other) noexcept;
  ~IdleRequest();

  [[nodiscard]] bool held() const noexcept { return descriptor_ >= 0; }
  /// Why it is not held, as the operating system puts it; empty: it is.
  [[nodiscard]] const std::string& reason() const noexcept { return reason_; }

 private:
  int descriptor_ = -1;
  std::string reason_ = "not asked for";
};

}  // namespace stilt::realtime
