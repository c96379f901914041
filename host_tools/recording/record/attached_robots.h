#pragma once

#include <string>
#include <vector>

#include "host_tools/recording/mcap/records.h"

namespace stilt::record {

/// Keeps the robots of URDF files that a record carries, so that robots::find() gives the recorded ones. The
/// files may be elsewhere, gone or edited. A shipped robot stays as it is shipped, unless it is unknown here.
/// Returns a sentence for each URDF that is wrong.
/// @param path  of the record
[[nodiscard]] std::vector<std::string> keep_attached_robots(const std::string& path,
                                                            const std::vector<mcap::Attachment>& attachments);

}  // namespace stilt::record
