#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "codegen/model/header_writer.h"
#include "codegen/urdf/urdf_reader.h"

namespace stilt::codegen {
namespace {

class CurrentTest : public testing::TestWithParam<const char*> {};

TEST_P(CurrentTest, TheCommittedHeadersAreWhatTheGeneratorEmits) {
  const std::string root = STILT_SOURCE_DIR "/codegen/";
  const std::string robot = GetParam();
  const PlanarTree tree = read_urdf(root + "robots/" + robot + ".urdf");
  for (const auto& [name, text] : write_headers(tree, robot, robot + ".urdf")) {
    std::ifstream stream(root + "generated/" + robot + "/" + name, std::ios::binary);
    const std::string committed(std::istreambuf_iterator<char>(stream), {});
    EXPECT_TRUE(committed == text) << robot << "/" << name
                                   << " is not current: build the target `regenerate`";
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, CurrentTest, testing::Values("amber3m", "amber3m_2020", "amber3m_lumped", "rabbit"),
                         [](const auto& parameter) { return std::string(parameter.param); });

}  // namespace
}  // namespace stilt::codegen
