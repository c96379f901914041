#include "firmware/telemetry/writer.h"

namespace stilt::telemetry {

std::expected<AnyWriter, std::string> AnyWriter::open(const Participant& participant, const Topic& topic) {
  AnyWriter made;
  dds_qos_t* quality = quality_of(topic);
  made.topic_ =
      Entity(dds_create_topic(participant.handle(), topic.type, topic.name.data(), quality, nullptr));
  made.writer_ = Entity(dds_create_writer(participant.handle(), made.topic_.get(), quality, nullptr));
  dds_delete_qos(quality);
  if (made.writer_.get() > 0) return made;
  return std::unexpected("telemetry cannot send " + std::string(topic.name) + ": " +
                         dds_strretcode(made.writer_.get()));
}

int AnyWriter::subscribers() const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(writer_.get(), &status);
  return static_cast<int>(status.current_count);
}

}  // namespace stilt::telemetry
