#include "firmware/telemetry/token.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"

namespace stilt::telemetry {
namespace {

std::expected<std::string, std::string> write_token(const std::string& path) {
  const auto file = TokenFile::hold(path);
  return file ? file->write() : std::unexpected(file.error());
}

class Token : public testing::Test {
 protected:
  tests::OwnFolder own;
  std::filesystem::path folder = own.path() / "stilt";  ///< made with the token
  std::string path = (folder / "token").string();
};

TEST_F(Token, is_written_for_its_owner_alone_and_reads_back) {
  const auto written = write_token(path);
  ASSERT_TRUE(written.has_value()) << written.error();
  EXPECT_EQ(written->size(), 32u);
  struct stat status{};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_EQ(read_token(path), written);
}

TEST_F(Token, is_another_one_every_time) {
  const auto first = write_token(path);
  const auto second = write_token(path);
  ASSERT_TRUE(first && second);
  EXPECT_NE(*first, *second);
  EXPECT_EQ(read_token(path), second);
}

TEST_F(Token, that_others_may_read_or_write_is_refused_with_what_would_be_right) {
  ASSERT_TRUE(write_token(path).has_value());
  for (const mode_t mode : {0644, 0640, 0604, 0620, 0602}) {
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    const auto read = read_token(path);
    ASSERT_FALSE(read.has_value()) << mode;
    EXPECT_NE(read.error().find("chmod 600"), std::string::npos);
  }
  ASSERT_EQ(chmod(path.c_str(), 0400), 0);
  EXPECT_TRUE(read_token(path).has_value());
}

TEST_F(Token, that_is_short_or_missing_is_refused) {
  EXPECT_FALSE(read_token(path).has_value());
  std::filesystem::create_directory(folder);
  std::ofstream(path) << "short\n";
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  EXPECT_NE(read_token(path).error().find("16 to 256 characters"), std::string::npos);
  std::ofstream(path) << "fifteen-letters\n";
  EXPECT_FALSE(read_token(path).has_value());
  std::ofstream(path) << "sixteen--letters\n";
  EXPECT_TRUE(read_token(path).has_value());
}

TEST_F(Token, has_the_form_of_one_and_not_that_of_another_secret) {
  std::filesystem::create_directory(folder);
  std::ofstream(path) << "";
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  const std::string longest(256, 'a');
  for (const std::string& token : {std::string("a-b_c+d/0123456="), longest}) {
    std::ofstream(path) << token << "\nmore\n";
    EXPECT_EQ(read_token(path), token);
    std::ofstream(path) << token;
    EXPECT_EQ(read_token(path), token) << "the end of the line is the end of the file";
  }
  for (const std::string& other :
       {longest + "a", std::string(1 << 20, 'a'), std::string(16, '\0'),
        std::string("root:$6$0123456789abcdef:1:"), std::string("machine example.com login anna")}) {
    std::ofstream(path) << other << "\n";
    const auto read = read_token(path);
    ASSERT_FALSE(read.has_value()) << other.substr(0, 40);
    EXPECT_NE(read.error().find("letters, digits"), std::string::npos);
  }
}

/// The path of a token may come from anybody on the network.
TEST_F(Token, is_in_a_regular_file_of_this_user_and_nothing_else_is_waited_for) {
  ASSERT_TRUE(write_token(path).has_value());
  const std::string fifo = (folder / "fifo").string(), link = (folder / "link").string();
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  ASSERT_EQ(symlink(path.c_str(), link.c_str()), 0);
  for (const std::string& other : {fifo, folder.string(), link, std::string("/dev/zero"), std::string()}) {
    EXPECT_FALSE(read_token(other).has_value()) << other;
  }
  EXPECT_NE(read_token(fifo).error().find("no regular file"), std::string::npos);
  ASSERT_TRUE(read_token(path).has_value());
  constexpr uid_t kNobody = 65534;
  if (chown(path.c_str(), kNobody, static_cast<gid_t>(-1)) != 0) GTEST_SKIP() << "only root gives files away";
  EXPECT_NE(read_token(path).error().find("another user"), std::string::npos);
}

TEST_F(Token, is_not_written_where_others_may_write) {
  std::filesystem::create_directory(folder);
  for (const mode_t mode : {0777, 0770, 0707}) {
    ASSERT_EQ(chmod(folder.c_str(), mode), 0);
    const auto written = write_token(path);
    ASSERT_FALSE(written.has_value()) << mode;
    EXPECT_NE(written.error().find("others may write"), std::string::npos);
  }
  ASSERT_EQ(chmod(folder.c_str(), 01777), 0) << "as /tmp: files stay their owners'";
  EXPECT_TRUE(write_token(path).has_value());
}

TEST_F(Token, leaves_only_its_lock_beside_it_and_its_new_folder_to_its_owner_alone) {
  ASSERT_TRUE(write_token(path).has_value());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2) << "the token and its lock";
  struct stat status{};
  ASSERT_EQ(stat(folder.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0700u);
}

TEST_F(Token, of_a_run_is_not_replaced_by_another_until_the_run_ends) {
  std::string first;
  {
    const auto running = TokenFile::hold(path);
    ASSERT_TRUE(running.has_value()) << running.error();
    first = running->write().value();
    const auto second = TokenFile::hold(path);
    ASSERT_FALSE(second.has_value());
    EXPECT_NE(second.error().find("as process " + std::to_string(getpid())), std::string::npos)
        << second.error();
    EXPECT_NE(second.error().find("telemetry.domain"), std::string::npos) << second.error();
    EXPECT_EQ(read_token(path), first);
  }
  EXPECT_TRUE(TokenFile::hold(path).has_value()) << "a run that has ended, or was killed, holds nothing";
  EXPECT_EQ(read_token(path), first) << "written when the next run takes commands, not before";
}

TEST(TokenPath, auto_is_in_the_users_own_folder_and_other_paths_are_taken) {
  EXPECT_EQ(token_path("/etc/stilt/token", 3), "/etc/stilt/token");
  setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  EXPECT_EQ(token_path("auto", 3), "/run/user/7/stilt/token-3");
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(token_path("auto", 3), "/tmp/stilt-" + std::to_string(geteuid()) + "/token-3");
}

TEST(RunId, is_a_number_that_javascript_holds_exactly) {
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t run_id = random_run_id();
    EXPECT_GT(run_id, 0u);
    EXPECT_LT(run_id, std::uint64_t{1} << 53);
  }
}

}  // namespace
}  // namespace stilt::telemetry
