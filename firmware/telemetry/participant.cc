#include "firmware/telemetry/participant.h"

#include <net/if.h>
#include <pthread.h>

#include <array>
#include <filesystem>

#include "firmware/configuration/peers.h"
#include "firmware/telemetry/udp_sockets.h"

namespace stilt::telemetry {
namespace {

/// Of Cyclone's threads; the system's default of 8 MB would be locked whole. The thread sanitizer keeps more
/// than 256 kB for itself in each stack, and no thread could start.
#ifdef __SANITIZE_THREAD__
constexpr std::size_t kStack_bytes = 8 * 1024 * 1024;
#else
constexpr std::size_t kStack_bytes = 256 * 1024;
#endif

/// While it lives, threads of this process get small stacks.
class SmallStacks {
 public:
  SmallStacks() {
    pthread_attr_init(&before_);
    pthread_getattr_default_np(&before_);
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, kStack_bytes);
    pthread_setattr_default_np(&small);
    pthread_attr_destroy(&small);
  }
  ~SmallStacks() {
    pthread_setattr_default_np(&before_);
    pthread_attr_destroy(&before_);
  }
  SmallStacks(const SmallStacks&) = delete;
  SmallStacks& operator=(const SmallStacks&) = delete;

 private:
  pthread_attr_t before_{};
};

std::string peers_xml(const Network& network, bool loopback) {
  std::string xml;
  if (loopback) xml += "<Peer address=\"127.0.0.1\"/>";
  for (const std::string& peer : configuration::peer_entries(network.peers)) {
    xml += "<Peer address=\"" + peer + "\"/>";
  }
  return xml.empty() ? xml : "<Peers>" + xml + "</Peers>";
}

constexpr std::array kSecurityFiles = {"ca_identity.pem", "ca_permissions.pem", "certificate.pem",
                                       "key.pem",         "governance.p7s",     "permissions.p7s"};

std::string security_xml(const std::string& folder) {
  const auto file = [&](const char* name) { return "file:" + folder + "/" + name; };
  return "<Security><Authentication>"
         "<Library initFunction=\"init_authentication\" finalizeFunction=\"finalize_authentication\" "
         "path=\"dds_security_auth\"/>"
         "<IdentityCA>" +
         file(kSecurityFiles[0]) + "</IdentityCA><IdentityCertificate>" + file(kSecurityFiles[2]) +
         "</IdentityCertificate><PrivateKey>" + file(kSecurityFiles[3]) +
         "</PrivateKey></Authentication><AccessControl>"
         "<Library initFunction=\"init_access_control\" finalizeFunction=\"finalize_access_control\" "
         "path=\"dds_security_ac\"/>"
         "<PermissionsCA>" +
         file(kSecurityFiles[1]) + "</PermissionsCA><Governance>" + file(kSecurityFiles[4]) +
         "</Governance><Permissions>" + file(kSecurityFiles[5]) +
         "</Permissions></AccessControl><Cryptographic>"
         "<Library initFunction=\"init_crypto\" finalizeFunction=\"finalize_crypto\" "
         "path=\"dds_security_crypto\"/></Cryptographic></Security>";
}

/// DDS Security gives no reason either when a certificate is not valid by the clock of the computer.
std::string validity_text(const std::string& security_folder) {
  if (security_folder.empty()) return {};
  return "; the clock must be within the validity of telemetry.security_folder: see date, and openssl x509 "
         "-noout "
         "-dates -in " +
         security_folder + "/" + kSecurityFiles[2];
}

/// What Cyclone would only report in its log.
std::expected<void, std::string> check(const Network& network) {
  if (if_nametoindex(network.interface.c_str()) == 0) {
    return std::unexpected("telemetry.interface \"" + network.interface +
                           "\" does not exist here; name one that `ip link` lists, such as lo");
  }
  if (const auto mistake = configuration::peers_mistake(network.peers)) {
    return std::unexpected("telemetry.peers: " + *mistake);
  }
  if (network.security_folder.empty()) return {};
  for (const char* name : kSecurityFiles) {
    const std::string path = network.security_folder + "/" + name;
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) continue;
    if (error && error != std::errc::no_such_file_or_directory) {
      return std::unexpected("telemetry.security_folder: " + path + " cannot be read (" + error.message() +
                             "); give its folder to the user of this program");
    }
    return std::unexpected("telemetry.security_folder: " + path +
                           " is missing; see docs/security.md on how to make the documents");
  }
  return {};
}

}  // namespace

std::string to_xml(const Network& network) {
  const bool loopback = network.interface == "lo";
  // Unicast on loopback, where multicast is mostly off; a record of 20 MB may wait for its readers.
  return std::string("<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"") +
         network.interface + "\"/></Interfaces><AllowMulticast>" + (loopback ? "false" : "spdp") +
         "</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
         "<MaxAutoParticipantIndex>63</MaxAutoParticipantIndex>" +
         peers_xml(network, loopback) +
         "</Discovery><Internal><Watermarks><WhcHigh>64MB</WhcHigh></Watermarks><Test><XmitLossiness>" +
         std::to_string(network.lost_permille) + "</XmitLossiness></Test></Internal>" +
         (network.security_folder.empty() ? "" : security_xml(network.security_folder)) +
         "</Domain></CycloneDDS>";
}

std::expected<Participant, std::string> Participant::open(const Network& network) {
  if (const auto right = check(network); !right) return std::unexpected(right.error());
  const SmallStacks stacks;
  Participant made;
  const auto domain = static_cast<dds_domainid_t>(network.domain);
  const auto sockets = udp_sockets();
  if (!sockets) return std::unexpected(sockets.error());
  dds_return_t result = dds_create_domain(domain, to_xml(network).c_str());
  if (result > 0) made.domain_ = Entity(result);
  if (const auto kept = restrict_new_sockets(*sockets, network.interface); !kept) {
    return std::unexpected(kept.error());
  }
  // A second participant of this process joins the domain as the first one set it up.
  if (result > 0 || result == DDS_RETCODE_PRECONDITION_NOT_MET) {
    result = dds_create_participant(domain, nullptr, nullptr);
    if (result > 0) {
      made.participant_ = Entity(result);
      if (const auto kept = restrict_new_sockets(*sockets, network.interface); !kept) {
        return std::unexpected(kept.error());
      }
      return made;
    }
  }
  return std::unexpected("telemetry cannot start on interface " + network.interface + ", domain " +
                         std::to_string(network.domain) + ": " + dds_strretcode(result) +
                         "; its address must be up, and at most 64 programs share a domain on one machine" +
                         validity_text(network.security_folder));
}

int Participant::others() const {
  const Entity reader(dds_create_reader(handle(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr));
  std::array<void*, 64> samples{};
  std::array<dds_sample_info_t, 64> infos{};
  const dds_return_t count = dds_take(reader.get(), samples.data(), infos.data(), samples.size(), 64);
  if (count <= 0) return 0;
  int alive = 0;
  for (dds_return_t i = 0; i < count; ++i) {
    alive += infos[static_cast<std::size_t>(i)].instance_state == DDS_IST_ALIVE ? 1 : 0;
  }
  dds_return_loan(reader.get(), samples.data(), count);
  return alive - 1;
}

}  // namespace stilt::telemetry
