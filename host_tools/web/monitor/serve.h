#pragma once

#include <atomic>
#include <functional>

#include "host_tools/web/monitor/sample_source.h"
#include "host_tools/web/monitor/web_server.h"

namespace stilt::monitor {

struct ServeOptions {
  ServerOptions server;
  bool open_browser = false;
  const std::atomic<bool>* stop = nullptr;  ///< ends when it becomes true
  /// Called once before the first page: more endpoints on the same server.
  std::function<void(WebServer&)> extend = [](WebServer&) {};
};

/// Serves the page of a source until it is stopped. Prints the address on standard output. Throws
/// std::runtime_error with a sentence when the address cannot be listened on.
void serve(SampleSource& source, const ServeOptions& options);

}  // namespace stilt::monitor
