#include "host_tools/recording/record/record_version.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "host_tools/recording/record/recorder.h"
#include "tests/host_tools/recording/mcap/sample_file.h"
#include "tests/host_tools/recording/record_sample.h"

namespace stilt::record {
namespace {

/// Error of require_wire_version() without the path; empty: the record is accepted.
std::string refusal(const std::string& path) {
  try {
    require_wire_version(path);
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path + ": ")) << text;
    return text.substr(path.size() + 2);
  }
  return {};
}

TEST(RecordVersion, ARecordOfThisReleaseIsAccepted) {
  const mcap::TemporaryFile file("current");
  {
    Recorder recorder(file.path(), {});
    recorder.take(ticks_sample(7, 0, 20), 1);
    recorder.take(configuration_sample(7, ""), 2);
  }
  EXPECT_EQ(refusal(file.path()), "");
}

TEST(RecordVersion, ARecordWithoutAConfigurationIsAccepted) {
  const mcap::TemporaryFile file("ticks");
  {
    Recorder recorder(file.path(), {});
    recorder.take(ticks_sample(7, 0, 20), 1);
  }
  EXPECT_EQ(refusal(file.path()), "");
}

TEST(RecordVersion, ANewerWireVersionIsRefusedWithBothNumbers) {
  const mcap::TemporaryFile file("newer");
  {
    Recorder recorder(file.path(), {});
    recorder.take(ticks_sample(7, 0, 20), 1);
    recorder.take(configuration_sample(7, "", 4), 2);
  }
  EXPECT_EQ(refusal(file.path()),
            "has messages of wire version 4, but this stilt reads wire version 3; use the stilt of the same "
            "release as stiltd");
}

TEST(RecordVersion, ARecordOfRelease01IsRefusedByItsDefinitions) {
  const mcap::TemporaryFile file("first");
  write_record_of_0_1(file.path());
  EXPECT_EQ(refusal(file.path()),
            "has the messages of release 0.1, but this stilt reads wire version 3; use the stilt of the same "
            "release as stiltd");
}

}  // namespace
}  // namespace stilt::record
