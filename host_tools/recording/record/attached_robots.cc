#include "host_tools/recording/record/attached_robots.h"

#include <algorithm>
#include <string_view>

#include "firmware/robots/robots.h"

namespace stilt::record {
namespace {

bool is_shipped(const std::string& robot) {
  const auto shipped = robots::shipped_urdfs();
  return std::ranges::find(shipped, robot, &robots::ShippedUrdf::name) != shipped.end();
}

}  // namespace

std::vector<std::string> keep_attached_robots(const std::string& path,
                                              const std::vector<mcap::Attachment>& attachments) {
  constexpr std::string_view kEnd = ".urdf";  // of the attachment's name, after the robot's
  std::vector<std::string> problems;
  for (const mcap::Attachment& attachment : attachments) {
    if (!attachment.name.ends_with(kEnd)) continue;
    const std::string robot = attachment.name.substr(0, attachment.name.size() - kEnd.size());
    if (is_shipped(robot)) continue;
    const auto kept = robots::keep(robot, attachment.data);
    if (!kept) problems.push_back(path + ": the attached URDF is wrong: " + kept.error());
  }
  return problems;
}

}  // namespace stilt::record
