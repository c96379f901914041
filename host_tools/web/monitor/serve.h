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
  /// Called once before the first page: adds endpoints to the same server.
  std::function<void(WebServer&)> extend = [](WebServer&) {};
};

/// Serves the page of a source until it is stopped. Prints the address on standard output. Throws
/// std::runtime_error with one sentence when it cannot listen on the address.
void serve(SampleSource& source, const ServeOptions& options);

}  // namespace stilt::monitor
