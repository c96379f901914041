#include "firmware/program/report.h"

#include <gtest/gtest.h>

namespace stilt::program {
namespace {

TEST(Report, ABusThatCannotCarryTheDriversIsRefused) {
  const configuration::Override one_bus[] = {{"hardware.buses=can0"}, {"hip_R.bus=0"}, {"knee_R.bus=0"}};
  const auto all_on_one = configuration::load_robot("amber3m", one_bus);
  ASSERT_TRUE(all_on_one) << configuration::to_string(all_on_one.error());
  const BusReport report = report_buses(*all_on_one);
  EXPECT_TRUE(report.refused);
  EXPECT_NE(report.text.find("bus can0: worst-case load 114 %"), std::string::npos) << report.text;
  EXPECT_FALSE(report_buses(*configuration::load_robot("amber3m")).refused);
}

TEST(Report, TheMachineIsDescribedWithWhatIsLacking) {
  realtime::Capability capability;
  capability.kernel = "6.1-rt";
  capability.cores = 4;
  capability.memory_locked = capability.priority_allowed = true;
  EXPECT_EQ(describe(capability),
            "kernel 6.1-rt, 4 processors, memory locked, priority granted\nreal time\n");
  capability.lacking = {"this", "that"};
  EXPECT_NE(describe(capability).find("not real time: this; that"), std::string::npos);
}

}  // namespace
}  // namespace stilt::program
