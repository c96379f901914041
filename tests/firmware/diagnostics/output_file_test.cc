#include "firmware/diagnostics/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/full_disk.h"
#include "tests/own_folder.h"

namespace stilt::diagnostics {
namespace {

std::string content(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::ptrdiff_t files_in(const tests::OwnFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()), {});
}

TEST(OutputFile, ReplacesAFileAndKeepsItsPermissions) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "old and longer";
  ASSERT_EQ(chmod(file.c_str(), 0640), 0);
  ASSERT_TRUE(write_file(file, "new"));
  EXPECT_EQ(content(file), "new");
  struct stat now{};
  ASSERT_EQ(stat(file.c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777, 0640u);
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, AFullDiskLeavesTheFileAsItWas) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "old";
  std::expected<void, std::string> written;
  {
    const tests::FullDisk full(16);
    written = write_file(file, std::string(1000, 'x'));
  }
  EXPECT_FALSE(written);
  EXPECT_EQ(content(file), "old");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, ATextInPiecesIsThereWholeOrNotAtAll) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("ticks.csv");
  const auto write = [&](int lines) {
    return write_file(file, [&]() -> std::string_view { return lines-- > 0 ? "line\n" : ""; }, false);
  };
  ASSERT_TRUE(write(2));
  EXPECT_EQ(content(file), "line\nline\n");
  {
    const tests::FullDisk full(1000);
    EXPECT_FALSE(write(10'000));
  }
  EXPECT_EQ(content(file), "line\nline\n");
  EXPECT_EQ(files_in(folder), 1);
}

TEST(OutputFile, ASymbolicLinkStaysOne) {
  const tests::OwnFolder folder;
  std::ofstream(folder.file("real.toml")) << "old";
  std::filesystem::create_symlink("real.toml", folder.file("link.toml"));
  ASSERT_TRUE(write_file(folder.file("link.toml"), "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.toml")));
  EXPECT_EQ(content(folder.file("real.toml")), "new");
}

TEST(OutputFile, DevicesAndFifosAreWrittenTo) {
  EXPECT_TRUE(write_file("/dev/null", "text"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_EQ(why_not_writable("/dev/null"), "");
  const auto full = write_file("/dev/full", "text");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error(), "No space left on device");
  const tests::OwnFolder folder;
  const std::string fifo = folder.file("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = content(fifo); });
  EXPECT_TRUE(write_file(fifo, "text"));
  reader.join();
  EXPECT_EQ(read, "text");
}

TEST(OutputFile, AMissingFolderIsNamedBeforeAndAfter) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("missing/robot.toml");
  EXPECT_EQ(why_not_writable(file), "No such file or directory");
  const auto written = write_file(file, "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), "No such file or directory");
}

TEST(OutputFile, AFileAsFolderIsNamedBeforeAndAfter) {
  const tests::OwnFolder folder;
  std::ofstream(folder.file("walk.mcap")) << "record";
  const std::string file = folder.file("walk.mcap/robot.json");
  EXPECT_EQ(why_not_writable(file), "Not a directory");
  const auto written = write_file(file, "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), "Not a directory");
}

TEST(OutputFile, TheLongestNameOfTheSystemIsWrittenAndALongerOneIsNamedBefore) {
  const tests::OwnFolder folder;
  const std::string longest = folder.file(std::string(255, 'a'));
  EXPECT_EQ(why_not_writable(longest), "");
  ASSERT_TRUE(write_file(longest, "text"));
  EXPECT_EQ(content(longest), "text");
  EXPECT_EQ(files_in(folder), 1);
  EXPECT_EQ(why_not_writable(longest + "a"), "File name too long");
}

}  // namespace
}  // namespace stilt::diagnostics
