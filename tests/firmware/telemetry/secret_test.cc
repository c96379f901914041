#include "firmware/telemetry/secret.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

namespace stilt::telemetry {
namespace {

/// RFC 4231, test cases 1, 2 and 6.
TEST(Secret, has_the_codes_of_the_standard) {
  EXPECT_EQ(hmac_sha256(std::string(20, '\x0b'), "Hi There"),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
  EXPECT_EQ(hmac_sha256("Jefe", "what do ya want for nothing?"),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT_EQ(hmac_sha256(std::string(131, '\xaa'), "Test Using Larger Than Block-Size Key - Hash Key First"),
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
}

/// Lengths around those of a block of SHA-256 and its end, by Python's hmac.
TEST(Secret, has_the_codes_of_another_program_for_every_length_that_ends_a_block) {
  struct Row {
    std::size_t key_bytes, text_bytes;
    const char* code;
  };
  const Row rows[] = {
      {0, 0, "b613679a0814d9ec772f95d778c35fc5ff1697c493715653c6c712144292c5ad"},
      {1, 1, "4659ddacc01743913080e8bbeb50d1276c137ba1d847d3703bcd60a030fb2127"},
      {63, 55, "985bd77064a1b2b5da51589f81b46f24eba5887a44f0692552fb873917f1e96c"},
      {64, 56, "868e4700276b16e2b0bc147a048de612f90d26c9546941b2a730825991a3b3ac"},
      {65, 63, "6bbe6c7634f8e347e20d9b447768b56f5353a211a740c0851540b08421f838de"},
      {131, 64, "18f9b89b30fcc3ef8240d3cb477a801085ee07845c34bb5a5194191a44bcd0a7"},
      {16, 119, "59f6cd691425c35fe0dce966205dd567ee09c294eee7ab7e71435567b5afc134"},
      {32, 120, "7d5560af5e3fe7407a78e100fc83d239d378c1f8eec3b92b0557aa79abae376b"},
      {200, 1000, "c3f57bc1331237f60608305584bc9525c979ab7135ae5af514cff2bfeb44f6dd"},
  };
  for (const Row& row : rows) {
    std::string key, text;
    for (std::size_t i = 0; i < row.key_bytes; ++i) key.push_back(static_cast<char>(7 * i + 1));
    for (std::size_t i = 0; i < row.text_bytes; ++i) text.push_back(static_cast<char>(11 * i + 3));
    EXPECT_EQ(hmac_sha256(key, text), row.code) << row.key_bytes << ", " << row.text_bytes;
  }
}

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
constexpr CommandText kCommand = {0x1085a41154fb89, "monitor-3fa9c1", 17, 4, 0.5, ""};

/// By Python's hmac and struct.
TEST(Secret, proves_a_command_by_the_code_of_all_its_fields) {
  EXPECT_EQ(proof(kToken, kCommand),
            "hmac-sha256:6f5962605250e22923cd4131702930a25b58d47deef78d308fbe552848c938b2");
}

TEST(Secret, proves_a_reply_by_the_code_of_all_its_fields_with_a_key_of_its_own) {
  const ReplyText reply = {0x1085a41154fb89, "monitor-3fa9c1", 17, false, "the robot sits", 2.5};
  EXPECT_EQ(proof(kToken, reply),
            "hmac-sha256:50a83e371110ccb3d02644e8beec84b7953352565fcc44571f437765dcd771c7");
}

TEST(Secret, proves_no_other_reply) {
  const ReplyText reply = {1, "me", 2, false, "no", 3.0};
  const std::string given = proof(kToken, reply);
  for (const ReplyText& other :
       {ReplyText{2, "me", 2, false, "no", 3.0}, ReplyText{1, "you", 2, false, "no", 3.0},
        ReplyText{1, "me", 3, false, "no", 3.0}, ReplyText{1, "me", 2, true, "no", 3.0},
        ReplyText{1, "me", 2, false, "", 3.0}, ReplyText{1, "me", 2, false, "no", 4.0}}) {
    EXPECT_NE(proof(kToken, other), given);
  }
  EXPECT_NE(proof("another token", reply), given);
}

TEST(Secret, proves_no_other_command) {
  const std::function<void(CommandText&)> changes[] = {
      [](CommandText& c) { ++c.run_id; },         [](CommandText& c) { c.commander = "monitor-3fa9c"; },
      [](CommandText& c) { ++c.number; },         [](CommandText& c) { ++c.kind; },
      [](CommandText& c) { c.value = -c.value; }, [](CommandText& c) { c.key = "1"; }};
  std::set<std::string> proofs = {proof(kToken, kCommand), proof("another token", kCommand)};
  for (const auto& change : changes) {
    CommandText other = kCommand;
    change(other);
    proofs.insert(proof(kToken, other));
  }
  EXPECT_EQ(proofs.size(), 8u);
  CommandText moved = kCommand;
  moved.commander = "ab", moved.key = "c";
  const std::string first = proof(kToken, moved);
  moved.commander = "a", moved.key = "bc";
  EXPECT_NE(proof(kToken, moved), first);
}

TEST(Secret, is_the_same_only_as_a_whole) {
  EXPECT_TRUE(same_secret("secret", "secret"));
  for (const char* other : {"", "s", "secre", "secreu", "Secret", "secret "}) {
    EXPECT_FALSE(same_secret(other, "secret")) << other;
  }
  EXPECT_FALSE(same_secret("", "")) << "no secret is known to all";
}

TEST(Secret, is_another_one_every_time) {
  const std::string first = random_secret();
  EXPECT_EQ(first.size(), 32u);
  EXPECT_EQ(first.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(first, random_secret());
}

}  // namespace
}  // namespace stilt::telemetry
