#include "firmware/configuration/peers.h"

#include <arpa/inet.h>

#include <algorithm>
#include <ranges>
#include <string_view>

namespace stilt::configuration {
namespace {

constexpr std::size_t kLongestName = 253, kLongestLabel = 63;  // RFC 1035
constexpr std::size_t kLongestPort = 5;
constexpr int kLargestPort = 65535;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool is_label(std::string_view label) {
  return !label.empty() && label.size() <= kLongestLabel && label.front() != '-' && label.back() != '-' &&
         std::ranges::all_of(label, [](char c) { return is_digit(c) || is_letter(c) || c == '-'; });
}

/// RFC 1123, 2.1. A name whose last label is a number would be taken for an address.
bool is_host_name(const std::string& name) {
  const auto last = name.substr(name.rfind('.') + 1);  // all of it without a point
  return name.size() <= kLongestName && !std::ranges::all_of(last, is_digit) &&
         std::ranges::all_of(name | std::views::split('.'),
                             [](const auto& label) { return is_label(std::string_view(label)); });
}

bool is_port(const std::string& text) {
  return !text.empty() && text.size() <= kLongestPort && std::ranges::all_of(text, is_digit) &&
         std::stoi(text) > 0 && std::stoi(text) <= kLargestPort;
}

bool is_peer(const std::string& entry) {
  const std::size_t colon = entry.find(':');
  const std::string host = entry.substr(0, colon);
  in_addr address{};
  return (colon == std::string::npos || is_port(entry.substr(colon + 1))) &&
         (inet_pton(AF_INET, host.c_str(), &address) == 1 || is_host_name(host));
}

}  // namespace

std::vector<std::string> peer_entries(const std::string& list) {
  std::vector<std::string> entries;
  for (const auto part : list | std::views::split(',')) {
    const std::string_view text(part);
    const auto first = text.find_first_not_of(' ');
    if (first == std::string_view::npos) continue;
    entries.emplace_back(text.substr(first, text.find_last_not_of(' ') - first + 1));
  }
  return entries;
}

std::optional<std::string> peers_mistake(const std::string& list) {
  for (const std::string& entry : peer_entries(list)) {
    if (!is_peer(entry)) {
      return "\"" + entry +
             "\" is neither an IPv4 address nor a host name; give both with commas between, such as "
             "192.168.1.20,robot.local";
    }
  }
  return std::nullopt;
}

}  // namespace stilt::configuration
