#pragma once

#include <dds/dds.h>

#include <expected>
#include <string>
#include <utility>

#include "firmware/telemetry/topics.h"

namespace stilt::telemetry {

/// Something of Cyclone DDS that is deleted with this object.
class Entity {
 public:
  Entity() noexcept = default;
  explicit Entity(dds_entity_t handle) noexcept : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  [[nodiscard]] dds_entity_t get() const noexcept { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

/// Where and how to meet others.
struct Network {
  int domain = 0;                ///< 0 to 230; robot and host use the same
  std::string interface = "lo";  ///< name of the one network interface; "lo": this machine alone
  std::string peers = {};        ///< addresses of others, separated by commas, where multicast does not work
  /// DDS Security: folder with the documents named in docs/security.md; empty: none.
  std::string security_folder = {};
  int lost_permille = 0;  ///< of the packets that are sent, thrown away: for tests
};

/// The configuration that a Network means, in Cyclone's XML.
[[nodiscard]] std::string to_xml(const Network& network);

/// A place on the network. Starts Cyclone's threads with small stacks. Call before memory is locked.
class Participant {
 public:
  /// The error is one sentence for the user.
  [[nodiscard]] static std::expected<Participant, std::string> open(const Network& network);

  [[nodiscard]] dds_entity_t handle() const noexcept { return participant_.get(); }

  /// How many other participants are known.
  [[nodiscard]] int others() const;

 private:
  Entity domain_;  // deleted last
  Entity participant_;
};

}  // namespace stilt::telemetry
