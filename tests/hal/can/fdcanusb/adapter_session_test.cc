#include "hal/can/fdcanusb/adapter_session.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stilt::hal::fdcanusb {
namespace {

constexpr const char* kGood = "lec=0 dlec=7 err=0 warn=0 busoff=0 pexc=0 tdc=19\r\n";
constexpr const char* kQuiet = "lec=7 dlec=7 err=0 warn=0 busoff=0 pexc=0 tdc=19\r\n";
constexpr const char* kUnacknowledged = "lec=3 dlec=7 err=1 warn=1 busoff=0 pexc=0 tdc=19\r\n";
constexpr const char* kOff = "lec=7 dlec=7 err=1 warn=1 busoff=1 pexc=0 tdc=19\r\n";

/// A conversation by hand, in virtual time.
class FdcanusbSession : public testing::Test {
 protected:
  FdcanusbSession() { session.begin(0, 0); }

  std::string said() {
    const auto output = session.output();
    std::string text(output.begin(), output.end());
    session.written(output.size());
    return text;
  }
  std::vector<CanFrame> answer(const std::string& text) {
    std::vector<CanFrame> frames;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    EXPECT_EQ(session.push({bytes, text.size()}), text.size());
    CanFrame frame;
    while (session.next(frame)) frames.push_back(frame);
    return frames;
  }
  void meet() {
    answer("ERR already in BusOn\r\n");
    answer(kQuiet);
    answer(kQuiet);
    ASSERT_TRUE(session.ready());
    static_cast<void>(said());
  }
  /// The next question for the status, and its answer.
  void status(const std::string& text) {
    now_ns += kStatusPeriod_ns;
    session.tick(now_ns);
    ASSERT_EQ(said(), "can status\n");
    answer(text);
  }
  void send(std::uint64_t sequence) {
    session.send(now_ns, classic_frame(static_cast<std::uint32_t>(sequence), 1), sequence);
    static_cast<void>(said());
  }

  AdapterSession session;
  std::int64_t now_ns = 0;
};

TEST_F(FdcanusbSession, BeginsAtAnAdapterInAnyState) {
  EXPECT_EQ(said(), "\n\ncan on\ncan status\n");
  EXPECT_TRUE(answer("OK\r\nERR unknown command\r\nrcv 10 00 e b f r\r\nOK\r\n").empty());
  EXPECT_FALSE(session.ready());
  answer(kQuiet);
  EXPECT_FALSE(session.ready());
  EXPECT_EQ(said(), "can status\n");
  answer(kQuiet);
  EXPECT_TRUE(session.ready());
}

TEST_F(FdcanusbSession, OkSettlesAFrameWhileTransfersSucceed) {
  meet();
  send(1);
  send(2);
  EXPECT_EQ(session.settled(), 0u);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 1u);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 2u);
  EXPECT_EQ(session.counts().taken, 2u);
}

TEST_F(FdcanusbSession, OkSettlesNothingOnceATransferHasFailed) {
  meet();
  send(1);
  answer("OK\r\n");
  status(kUnacknowledged);
  EXPECT_EQ(session.health(), BusHealth::passive);
  send(2);
  answer("OK\r\n");
  for (int i = 0; i < 20; ++i) status(kUnacknowledged);
  EXPECT_EQ(session.settled(), 1u);
  status(kGood);
  EXPECT_EQ(session.settled(), 2u);
  send(3);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 3u);
}

TEST_F(FdcanusbSession, TwoAnswersWithoutAnEventSettleWhatTheAdapterHasGivenUp) {
  meet();
  status(kUnacknowledged);
  send(1);
  answer("OK\r\n");
  status(kQuiet);
  EXPECT_EQ(session.settled(), 0u) << "it may not have begun";
  status(kQuiet);
  EXPECT_EQ(session.settled(), 1u);
  send(2);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 1u) << "nothing has succeeded since";
  status(kQuiet);
  status(kUnacknowledged);
  status(kQuiet);
  EXPECT_EQ(session.settled(), 1u) << "tried again between the two";
  status(kQuiet);
  EXPECT_EQ(session.settled(), 2u);
}

TEST_F(FdcanusbSession, BusOffIsCountedOnceAndAgainAfterARestartInVain) {
  meet();
  status(kOff);
  status(kOff);
  EXPECT_EQ(session.counts().bus_off, 1u);
  session.restart(now_ns);
  EXPECT_EQ(said(), "can off\ncan on\n");
  answer("OK\r\nOK\r\n");
  status(kOff);
  EXPECT_EQ(session.counts().bus_off, 2u);
  status(kGood);
  EXPECT_EQ(session.health(), BusHealth::active);
}

TEST_F(FdcanusbSession, AStatusOfTheTimeBeforeARestartIsNoBusOffAfterIt) {
  meet();
  status(kOff);
  now_ns += kStatusPeriod_ns;
  session.tick(now_ns);
  session.restart(now_ns);
  ASSERT_EQ(said(), "can status\ncan off\ncan on\n");
  answer(std::string(kOff) + "OK\r\nOK\r\n");
  EXPECT_EQ(session.counts().bus_off, 1u);
  status(kGood);
  EXPECT_EQ(session.counts().bus_off, 1u);
  status(kOff);
  EXPECT_EQ(session.counts().bus_off, 2u);
}

TEST_F(FdcanusbSession, ARefusedFrameIsSettledAndReported) {
  meet();
  send(1);
  answer("ERR unknown flag\r\n");
  EXPECT_EQ(session.settled(), 1u);
  EXPECT_EQ(session.counts().taken, 0u);
  EXPECT_EQ(session.counts().error_reports, 1u);
}

TEST_F(FdcanusbSession, AnAdapterThatIsNotOnIsSwitchedOn) {
  meet();
  send(1);
  answer("ERR not in BusOn state\r\n");
  EXPECT_EQ(said(), "can on\n");
  answer("OK\r\n");
  EXPECT_EQ(session.counts().malformed, 0u);
}

TEST_F(FdcanusbSession, AStatusOvertakesAnswersThatWereLost) {
  meet();
  send(1);
  send(2);
  status(kGood);
  EXPECT_EQ(session.settled(), 2u);
  EXPECT_EQ(session.counts().answers_lost, 2u);
  send(3);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 3u);
}

TEST_F(FdcanusbSession, AnOkAfterAStatusIsNoAnswerToAFrame) {
  answer(std::string(kQuiet) + "OK\r\n" + kQuiet);
  ASSERT_TRUE(session.ready());
  static_cast<void>(said());
  send(1);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 0u) << "that one ended the status";
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 1u);
}

TEST_F(FdcanusbSession, SkippedFramesSettleInOrder) {
  meet();
  send(1);
  session.skip(2);
  EXPECT_EQ(session.settled(), 0u);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 2u);
  session.skip(3);
  EXPECT_EQ(session.settled(), 3u);
}

TEST_F(FdcanusbSession, LinesComeInAnyPieces) {
  meet();
  const std::string line = "rcv 0100 01020304 e b f r x00\r\n";
  for (std::size_t i = 0; i + 2 < line.size(); ++i) EXPECT_TRUE(answer(line.substr(i, 1)).empty());
  EXPECT_EQ(answer("\r").size(), 1u);
  EXPECT_TRUE(answer("\n").empty());
  EXPECT_EQ(answer(line + line).size(), 2u);
  EXPECT_EQ(session.counts().malformed, 0u);
}

TEST_F(FdcanusbSession, ALineWithoutAnEndIsDroppedWhole) {
  meet();
  answer("rcv 0100 00 e b f r " + std::string(600, 'x'));
  EXPECT_TRUE(answer("x\r\n").empty());
  EXPECT_EQ(session.counts().malformed, 1u);
  EXPECT_EQ(answer("rcv 0100 00 e b f r\r\n").size(), 1u);
}

TEST_F(FdcanusbSession, AnAdapterWithoutAnswersIsSilent) {
  meet();
  send(1);
  constexpr std::int64_t kTimeout_ns = 1000;
  EXPECT_FALSE(session.silent(now_ns + kTimeout_ns, kTimeout_ns));
  EXPECT_TRUE(session.silent(now_ns + kTimeout_ns + 1, kTimeout_ns));
  answer("OK\r\n");
  EXPECT_FALSE(session.silent(now_ns + kTimeout_ns + 1, kTimeout_ns));
}

TEST_F(FdcanusbSession, AnAnswerToNothingIsMalformed) {
  meet();
  answer("OK\r\n");
  answer(kGood);
  EXPECT_EQ(session.counts().malformed, 2u);
  EXPECT_EQ(session.settled(), 0u);
}

TEST_F(FdcanusbSession, ANewConnectionGoesOnFromTheLast) {
  meet();
  send(1);
  answer("OK\r\n");
  send(2);
  session.begin(0, session.settled());
  static_cast<void>(said());
  meet();
  EXPECT_EQ(session.settled(), 1u);
  EXPECT_EQ(session.counts().taken, 1u);
  send(3);
  answer("OK\r\n");
  EXPECT_EQ(session.settled(), 3u);
}

TEST_F(FdcanusbSession, ThereIsRoomForABatchOfTheLongestFrames) {
  meet();
  CanFrame longest;
  longest.fd = longest.extended = true;
  longest.id = kMaximumExtendedId;
  longest.length = 64;
  for (std::uint64_t sequence = 1; sequence <= kMaximumBatch; ++sequence) {
    ASSERT_TRUE(session.has_room());
    session.send(0, longest, sequence);
  }
  std::uint64_t sequence = kMaximumBatch;
  while (session.has_room()) session.send(0, longest, ++sequence);
  session.tick(kStatusPeriod_ns);
  EXPECT_EQ(said().size() % (9 + 8 + 1 + 128 + 4), 0u) << "whole commands";
}

}  // namespace
}  // namespace stilt::hal::fdcanusb
