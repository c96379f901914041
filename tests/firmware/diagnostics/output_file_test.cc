#include "firmware/diagnostics/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

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

/// No file grows beyond this while the object lives: as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t most_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{most_bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(OutputFile, AFullDiskLeavesTheFileAsItWas) {
  const tests::OwnFolder folder;
  const std::string file = folder.file("robot.toml");
  std::ofstream(file) << "old";
  std::expected<void, std::string> written;
  {
    const FullDisk full(16);
    written = write_file(file, std::string(1000, 'x'));
  }
  EXPECT_FALSE(written);
  EXPECT_EQ(content(file), "old");
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

}  // namespace
}  // namespace stilt::diagnostics
