#include "firmware/telemetry/reader.h"

#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>

namespace stilt::telemetry {
namespace {

constexpr std::size_t kAtOnce = 64;

Cdr bytes_of(const ddsi_serdata& data) {
  Cdr cdr(ddsi_serdata_size(&data));
  ddsi_serdata_to_ser(&data, 0, cdr.size(), cdr.data());
  return cdr;
}

}  // namespace

std::expected<Reader, std::string> Reader::open(const Participant& participant, const Topic& topic,
                                                int keeps) {
  Reader made;
  made.about_ = &topic;
  dds_qos_t* quality = quality_of(topic);
  made.topic_ =
      Entity(dds_create_topic(participant.handle(), topic.type, topic.name.data(), quality, nullptr));
  // A sample of a stream that came just before the last one is not worth less.
  dds_qset_history(quality, DDS_HISTORY_KEEP_LAST, keeps > 0 ? keeps : std::max(topic.keeps, 16));
  made.reader_ = Entity(dds_create_reader(participant.handle(), made.topic_.get(), quality, nullptr));
  dds_delete_qos(quality);
  if (made.reader_.get() > 0) return made;
  return std::unexpected("telemetry cannot receive " + std::string(topic.name) + ": " +
                         dds_strretcode(made.reader_.get()));
}

int Reader::take(const std::function<void(Sample&&)>& use, int at_most) {
  std::array<ddsi_serdata*, kAtOnce> data{};
  std::array<dds_sample_info_t, kAtOnce> infos{};
  int taken = 0;
  while (taken < at_most) {
    const dds_return_t count = dds_takecdr(reader_.get(), data.data(), kAtOnce, infos.data(), DDS_ANY_STATE);
    for (dds_return_t i = 0; i < count; ++i) {
      const auto n = static_cast<std::size_t>(i);
      if (infos[n].valid_data) {
        use({about_, infos[n].source_timestamp, infos[n].publication_handle, bytes_of(*data[n])});
        ++taken;
      }
      ddsi_serdata_unref(data[n]);
    }
    if (count < static_cast<dds_return_t>(kAtOnce)) break;
  }
  return taken;
}

int Reader::senders() const {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(reader_.get(), &status);
  return static_cast<int>(status.current_count);
}

std::uint64_t Reader::lost() const {
  dds_sample_lost_status_t status{};
  dds_get_sample_lost_status(reader_.get(), &status);
  return status.total_count;
}

}  // namespace stilt::telemetry
