#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "codegen/model/header_writer.h"
#include "codegen/urdf/urdf_reader.h"

namespace stilt::codegen {
namespace {

/// Every shipped robot has the shape, and none of their numbers gets into the text.
TEST(CurrentTest, TheCommittedHeadersAreWhatTheGeneratorEmitsForEveryRobot) {
  const std::filesystem::path root = STILT_SOURCE_DIR "/codegen";
  for (const std::string robot : {"amber3m", "amber3m_2020", "rabbit"}) {
    const PlanarTree tree = read_urdf((root / "robots" / robot).replace_extension("urdf").string());
    for (const auto& [name, text] : write_headers(tree, robot, "five_link")) {
      std::ifstream stream(root / "generated/five_link" / name, std::ios::binary);
      const std::string committed(std::istreambuf_iterator<char>(stream), {});
      EXPECT_TRUE(committed == text) << name << " is not current for " << robot
                                     << ": build the target `regenerate`";
    }
  }
}

}  // namespace
}  // namespace stilt::codegen
