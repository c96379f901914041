#include "host_tools/web/monitor/own_names.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

namespace stilt::monitor {
namespace {

bool is_same(const std::string& host, const std::string& name) {
  return strcasecmp(host.c_str(), name.c_str()) == 0;
}

/// Whether a host is a loopback address or "localhost". A name such as 127.example.com can lead to any host.
bool is_loopback(const std::string& host) {
  in_addr number{};
  if (inet_pton(AF_INET, host.c_str(), &number) == 1) return (ntohl(number.s_addr) >> 24U) == IN_LOOPBACKNET;
  return is_same(host, "localhost") || host == "[::1]";
}

bool is_wildcard(const std::string& address) { return address == "0.0.0.0" || address == "::"; }

/// The host of "host:port" or "host".
std::string host_part(const std::string& host) {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  return has_port ? host.substr(0, colon) : host;
}

struct FreeAddresses {
  void operator()(ifaddrs* list) const { freeifaddrs(list); }
};

/// Addresses of this machine, loopback left out; of IPv6 those of wider than the link.
std::vector<std::string> addresses_of_machine() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, FreeAddresses> owned(list);
  std::vector<std::string> all;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr) continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    const void* number = nullptr;
    if (one->ifa_addr->sa_family == AF_INET) {
      number = &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr;
    } else if (one->ifa_addr->sa_family == AF_INET6) {
      const in6_addr& address = reinterpret_cast<const sockaddr_in6*>(one->ifa_addr)->sin6_addr;
      if (!IN6_IS_ADDR_LINKLOCAL(&address)) number = &address;
    }
    if (number == nullptr ||
        inet_ntop(one->ifa_addr->sa_family, number, text.data(), text.size()) == nullptr) {
      continue;
    }
    const std::string host = in_brackets(text.data());
    if (!is_loopback(host)) all.push_back(host);
  }
  return all;
}

std::string name_of_machine() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : std::string();
}

}  // namespace

std::string in_brackets(const std::string& address) {
  return address.find(':') == std::string::npos || address.starts_with('[') ? address : "[" + address + "]";
}

bool OwnNames::contain(const std::string& host_header) const {
  const std::string host = host_part(host_header);
  const auto is_host = [&host](const std::string& name) { return !name.empty() && is_same(host, name); };
  if (is_loopback(host) || std::ranges::any_of(named, is_host)) return true;
  const std::string own = in_brackets(address);
  if (is_loopback(own)) return false;
  const std::string machine = name_of_machine();
  return is_host(machine) || (!machine.empty() && is_host(machine + ".local")) ||
         std::ranges::any_of(for_others(), is_host);
}

std::vector<std::string> OwnNames::for_others() const {
  const std::string own = in_brackets(address);
  if (is_loopback(own)) return {};
  return is_wildcard(address) ? addresses_of_machine() : std::vector{own};
}

}  // namespace stilt::monitor
