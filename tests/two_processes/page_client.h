#pragma once

#include <mutex>
#include <string>
#include <thread>

namespace stilt::two_processes {

/// An open page of a monitor, as far as a test needs one. It is a WebSocket to /live that gives the key of
/// its link and reads all it is sent.
class PageClient {
 public:
  /// Throws std::runtime_error when it is not let in.
  /// @param url  as `stilt monitor` prints it, "http://127.0.0.1:8080/#key=..."
  explicit PageClient(const std::string& url);
  ~PageClient();
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  /// Sends a text message of at most 125 bytes.
  void send(const std::string& json);

  /// Waits until a text is in what came, at most that long.
  [[nodiscard]] bool wait_for(const std::string& text, double longest_s);

  /// The other end is gone.
  [[nodiscard]] bool wait_for_end(double longest_s);

 private:
  void read();

  int socket_ = -1;
  mutable std::mutex mutex_;  ///< of what follows
  std::string came_;          ///< frames as they came; texts in them are readable
  bool ended_ = false;
  std::jthread reader_;  ///< last: it uses the others
};

/// The link that a monitor prints, once it has; throws std::runtime_error when it takes longer.
/// @param output  file of its standard output
[[nodiscard]] std::string url_of_monitor(const std::string& output, double longest_s);

}  // namespace stilt::two_processes
