#include "host_tools/web/monitor/page_inbox.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <span>
#include <string>

#include "fake_peer.h"

namespace stilt::monitor {
namespace {

std::map<Peer*, std::size_t> messages_by_peer(PageInbox& inbox) {
  std::map<Peer*, std::size_t> all;
  for (const auto& [peer, text] : inbox.take()) ++all[peer];
  return all;
}

TEST(PageInbox, KeepsTheMessagesOfAPageInOrder) {
  PageInbox inbox;
  FakePeer page;
  inbox.open(page);
  for (const char* text : {"1", "2", "3"}) inbox.add(page, text);
  const auto taken = inbox.take();
  ASSERT_EQ(taken.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(taken[k].second, std::to_string(k + 1));
  EXPECT_TRUE(inbox.take().empty());
}

TEST(PageInbox, HasLittleRoomForAPageThatIsNotTrusted) {
  PageInbox inbox;
  FakePeer page;
  inbox.open(page);
  const std::string longest(65536, '[');
  for (int k = 0; k < 1000; ++k) inbox.add(page, longest);
  EXPECT_TRUE(inbox.take().empty());
  for (int k = 0; k < 1000; ++k) inbox.add(page, "{}");
  EXPECT_EQ(inbox.take().size(), PageInbox::kOfOthers.messages);
  inbox.trust(page, true);
  for (int k = 0; k < 1000; ++k) inbox.add(page, longest);
  EXPECT_EQ(inbox.take().size(), PageInbox::kOfTrusted.bytes / longest.size());
  for (int k = 0; k < 1000; ++k) inbox.add(page, "{}");
  EXPECT_EQ(inbox.take().size(), PageInbox::kOfTrusted.messages);
}

/// 64 messages and 64 kB are parsed in less than ten milliseconds, whatever is in them.
TEST(PageInbox, AStepTakesNoMoreOfHundredsOfPagesThanItCanParse) {
  PageInbox inbox;
  std::array<FakePeer, 250> pages;
  for (FakePeer& page : pages) inbox.open(page);
  const auto fill = [&](std::size_t bytes) {
    for (FakePeer& page : pages) {
      for (int k = 0; k < 20; ++k) inbox.add(page, std::string(bytes, '['));
    }
  };
  fill(2);
  EXPECT_EQ(inbox.take().size(), PageInbox::kPerStep.messages);
  for (FakePeer& page : pages) inbox.close(page);
  for (FakePeer& page : pages) inbox.open(page);
  fill(8000);
  std::size_t bytes = 0;
  for (const auto& [peer, text] : inbox.take()) bytes += text.size();
  EXPECT_GT(bytes, 0u);
  EXPECT_LE(bytes, PageInbox::kPerStep.bytes);
}

TEST(PageInbox, PagesThatSendWithoutEndDelayATrustedPageNotAtAllAndAnotherByAFewSteps) {
  PageInbox inbox;
  std::array<FakePeer, 252> pages;
  for (FakePeer& page : pages) inbox.open(page);
  const auto floods = std::span(pages).first<250>();
  FakePeer &trusted = pages[250], &other = pages[251];  // the last in the order of addresses
  inbox.trust(trusted, true);
  inbox.add(trusted, "stop");
  inbox.add(other, "stop");
  bool came = false;
  for (int step = 0; step < 4; ++step) {
    for (FakePeer& page : floods) {
      for (int k = 0; k < 100; ++k) inbox.add(page, "{}");
    }
    const auto taken = messages_by_peer(inbox);
    EXPECT_EQ(taken.contains(&trusted), step == 0);
    came = came || taken.contains(&other);
  }
  EXPECT_TRUE(came) << "each page has its turn: 251 messages, 64 per step";
}

TEST(PageInbox, NothingWaitsForAPageThatIsClosed) {
  PageInbox inbox;
  FakePeer page;
  inbox.add(page, "{}");
  EXPECT_TRUE(inbox.take().empty()) << "not open yet";
  inbox.open(page);
  inbox.trust(page, true);
  inbox.add(page, "{}");
  inbox.close(page);
  inbox.add(page, "{}");
  inbox.open(page);
  EXPECT_TRUE(inbox.take().empty());
  for (int k = 0; k < 1000; ++k) inbox.add(page, "{}");
  EXPECT_EQ(inbox.take().size(), PageInbox::kOfOthers.messages) << "trust ended with the connection";
}

}  // namespace
}  // namespace stilt::monitor
