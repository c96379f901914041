#include "firmware/diagnostics/input_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/own_folder.h"

namespace stilt::diagnostics {
namespace {

TEST(InputFile, IsReadToItsEndWithAllItsBytes) {
  const tests::OwnFolder folder;
  const std::string text = std::string(10'000, 'x') + std::string("\0\r\n", 3);
  std::ofstream(folder.file("text"), std::ios::binary) << text;
  EXPECT_EQ(read_file(folder.file("text")), text);
  EXPECT_EQ(read_file("/dev/null"), "");
}

TEST(InputFile, ThatIsMissingAFolderOrBrokenHasTheSystemsReason) {
  const tests::OwnFolder folder;
  EXPECT_EQ(read_file(folder.file("none")).error(), "No such file or directory");
  EXPECT_EQ(read_file(folder.path()).error(), "Is a directory");
  EXPECT_EQ(read_file("/proc/self/mem").error(), "Input/output error") << "nothing is at address 0";
  EXPECT_EQ(read_file("/dev/zero").error(), "File too large");
}

}  // namespace
}  // namespace stilt::diagnostics
