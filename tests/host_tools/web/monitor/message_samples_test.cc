#include "host_tools/web/monitor/message_samples.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace stilt::monitor {
namespace {

TEST(MessageSamples, APlanWhoseSequencesContradictEachOtherHasNoNodes) {
  std::array<float, 3> times{0.0f, 0.1f, 0.2f}, base{0.0f, 0.8f, 0.0f};
  telemetry::Plan message{};
  message.time_s._buffer = times.data();
  message.time_s._length = 3;
  message.base._buffer = base.data();
  message.base._length = 3;
  EXPECT_TRUE(plan_sample(message).nodes.empty());
}

TEST(MessageSamples, ANodeOfAPlanHasItsTimeBaseFeetForcesAndStanceFeet) {
  std::array<float, 2> times{0.0f, 0.25f};
  std::array<std::uint8_t, 2> contact{1, 2};
  std::array<float, 6> base{0.0f, 0.75f, 0.5f, 1.0f, 0.875f, -0.5f};
  std::array<float, 8> feet{1, 2, 3, 4, 5, 6, 7, 8}, forces{10, 20, 30, 40, 50, 60, 70, 80};
  const auto set_view = [](auto& sequence, auto& numbers) {
    sequence._buffer = numbers.data();
    sequence._length = static_cast<std::uint32_t>(numbers.size());
  };
  telemetry::Plan message{};
  message.start_time_s = 2.0;
  set_view(message.time_s, times);
  set_view(message.contact, contact);
  set_view(message.base, base);
  set_view(message.foot_position_m, feet);
  set_view(message.contact_force_N, forces);
  const std::vector<PlanNodeSample> nodes = plan_sample(message).nodes;
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_TRUE(nodes[0].left_stance && !nodes[0].right_stance);
  EXPECT_TRUE(!nodes[1].left_stance && nodes[1].right_stance);
  EXPECT_EQ(nodes[1].time_s, 2.25);
  EXPECT_EQ(nodes[1].base_x_m, 1.0);
  EXPECT_EQ(nodes[1].base_z_m, 0.875);
  EXPECT_EQ(nodes[1].pitch_rad, -0.5);
  EXPECT_EQ(nodes[1].foot_position_m[3], 8.0);
  EXPECT_EQ(nodes[1].contact_force_N[0], 50.0);
}

TEST(MessageSamples, EmptyBinsOfAHistogramAreLeftOutAndEdgesStayTheirs) {
  std::array<float, 3> edges{64.0f, 72.0f, 80.0f};
  std::array<std::uint64_t, 3> counts{5, 0, 7};
  char name[] = "wakeup_latency";
  stilt_msgs_msg_dds__Histogram_ histogram{};
  histogram.name = name;
  histogram.lower_edge_us._buffer = edges.data();
  histogram.lower_edge_us._length = 3;
  histogram.bin._buffer = counts.data();
  histogram.bin._length = 3;
  telemetry::Timing message{};
  message.histograms._buffer = &histogram;
  message.histograms._length = 1;
  const TimingSample sample = timing_sample(message);
  ASSERT_EQ(sample.histograms.size(), 1u);
  EXPECT_EQ(sample.histograms[0].upper_edge_us, (std::vector<double>{72.0, 90.0}));
  EXPECT_EQ(sample.histograms[0].in_bin, (std::vector<std::uint64_t>{5, 7}));
}

}  // namespace
}  // namespace stilt::monitor
