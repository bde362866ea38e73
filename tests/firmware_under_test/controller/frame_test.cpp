// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>
#include <utility>

#include <gtest/gtest.h>

#include "firmware_under_test/controller/release.h"
#include "runner.h"

namespace kerfbench::controller_test {
namespace {

TEST(Crc, HasTheCheckValueOfCcittFalse) {
  const std::string text = "123456789";
  EXPECT_EQ(fakeCrc(reinterpret_cast<const std::uint8_t*>(text.data()), 9), 0x29B1);
}

TEST(Frame, HelloIsAcknowledgedWithInfo) {
  Runner runner;
  const auto answer = runner.ask(frame(KB_HELLO, 9));
  auto want = frame(KB_ACK, 9, {0xFF, 0x0F});
  std::vector<std::uint8_t> payload{KB_PROTOCOL_VERSION, 0x00, 0x10, 0x90, 0x01, 32};
  const auto* const block = reinterpret_cast<const std::uint8_t*>(&kb_release);
  payload.insert(payload.end(), block, block + KB_RELEASE_LEN);
  const auto info = frame(KB_INFO, 9, payload);
  for (const std::uint8_t byte : info) want.push_back(byte);
  EXPECT_EQ(answer, want);
}

TEST(Frame, ADamagedFrameIsRefusedAndLeavesNoTrace) {
  Runner runner;
  auto bytes = JobCheck({}).data(1, {KB_OP_MOVE | 1, 5, KB_OP_END});
  bytes[5] ^= 0x10;
  EXPECT_EQ(runner.ask(bytes), frame(KB_NAK, 1, {KB_NAK_CRC}));
  EXPECT_EQ(fakeQueueFree(), KB_QUEUE_SIZE - 1);
}

TEST(Frame, ARepeatedFrameIsAnsweredButNotExecutedTwice) {
  Runner runner;
  const auto bytes = JobCheck({}).data(1, {KB_OP_MOVE | 1, 5});
  const auto first = runner.ask(bytes);
  EXPECT_EQ(runner.ask(bytes), first);
  EXPECT_EQ(fakeQueueFree(), KB_QUEUE_SIZE - 1 - 2);
}

TEST(Frame, ATruncatedFrameIsForgottenAfterAPause) {
  Runner runner;
  auto bytes = frame(KB_CONFIG, 1, config());
  bytes.resize(7);
  EXPECT_TRUE(runner.ask(bytes).empty());
  runner.run(40 * 32);
  EXPECT_EQ(runner.ask(frame(KB_CONFIG, 2, config())), frame(KB_ACK, 2, {0xFF, 0x0F}));
}

TEST(Frame, GarbageDoesNotStopItFromAnswering) {
  Runner runner;
  for (int i = 0; i < 20000; ++i) runner.write({static_cast<std::uint8_t>(runner.random())});
  runner.run(20000 * 2 + 40 * 32);
  const auto answer = runner.ask(frame(KB_CONFIG, 200, config()));
  EXPECT_EQ(answer, frame(KB_ACK, 200, {0xFF, 0x0F}));
}

TEST(Frame, RefusesWhatTheStateForbids) {
  Runner runner;
  EXPECT_EQ(runner.ask(frame(KB_START, 1, JobCheck({}).bytes())), frame(KB_NAK, 1, {KB_NAK_STATE}));
  EXPECT_EQ(runner.ask(frame(0x55, 2)), frame(KB_NAK, 2, {KB_NAK_TYPE}));
  EXPECT_EQ(runner.ask(frame(KB_CONFIG, 3, config(0, 0, 100))), frame(KB_NAK, 3, {KB_NAK_VALUE}));
  EXPECT_EQ(runner.ask(frame(KB_HELLO, 4, {1})), frame(KB_NAK, 4, {KB_NAK_LENGTH}));
  EXPECT_EQ(runner.ask(frame(KB_START, 5)), frame(KB_NAK, 5, {KB_NAK_LENGTH}));
}

TEST(Frame, RefusesAProgramThatIsNotTheOneSent) {
  Runner runner;
  runner.ask(frame(KB_CONFIG, 1, config()));
  JobCheck check(config());
  const auto first = check.data(2, {KB_OP_MOVE | 1, 5});
  const auto second = check.data(3, {KB_OP_MOVE | 1, 6});
  EXPECT_EQ(runner.ask(second), frame(KB_NAK, 3, {KB_NAK_CHECK})) << "the one before it is missing";
  EXPECT_EQ(fakeQueueFree(), KB_QUEUE_SIZE - 1);
  EXPECT_EQ(runner.ask(first), frame(KB_ACK, 2, {0xFD, 0x0F}));
  EXPECT_EQ(runner.ask(frame(KB_START, 4, check.bytes())), frame(KB_NAK, 4, {KB_NAK_CHECK}));
  EXPECT_EQ(runner.ask(second), frame(KB_ACK, 3, {0xFB, 0x0F}));
  auto wrong_config = check.bytes();
  wrong_config[0] ^= 1;
  EXPECT_EQ(runner.ask(frame(KB_START, 5, wrong_config)), frame(KB_NAK, 5, {KB_NAK_CHECK}));
  const auto started = runner.ask(frame(KB_START, 6, check.bytes()));
  const auto ack = frame(KB_ACK, 6, {0xFB, 0x0F});
  EXPECT_TRUE(std::equal(ack.begin(), ack.end(), started.begin()));
}

TEST(Frame, RefusesPulsesThatItCannotMake) {
  const std::vector<std::uint8_t> good = config();
  ASSERT_EQ(good.size(), std::size_t(KB_CONFIG_LEN));
  std::uint8_t seq = 0;
  const auto answer = [&](std::initializer_list<std::pair<std::size_t, int>> changes) {
    std::vector<std::uint8_t> bytes = good;
    for (const auto& [at, value] : changes) bytes[at] = static_cast<std::uint8_t>(value);
    Runner runner;
    ++seq;
    return runner.ask(frame(KB_CONFIG, seq, bytes)) == frame(KB_NAK, seq, {KB_NAK_VALUE});
  };
  EXPECT_FALSE(answer({}));
  EXPECT_TRUE(answer({{14, 4}})) << "the laser's gate is no pin of an axis";
  EXPECT_TRUE(answer({{15, 1}})) << "held for no tick";
  EXPECT_TRUE(answer({{15, 1}, {16, 1}})) << "a pulse in each tick, held for one";
  EXPECT_FALSE(answer({{15, 1}, {16, 1}, {17, 16}, {22, 16}}));
  EXPECT_TRUE(answer({{15, 1}, {16, 1}, {17, 17}, {22, 16}}));
  EXPECT_TRUE(answer({{15, 1}, {16, KB_WIDE_TICKS_MAX + 1}, {17, 1}, {22, 1}}));
  EXPECT_TRUE(answer({{15, 0x20}, {16, 1}})) << "no such axis";
  EXPECT_TRUE(answer({{18, 32}})) << "more steps than ticks";
  EXPECT_TRUE(answer({{18, 8}})) << "it turns at 31, but never makes them";
}

TEST(Frame, RefusesDataThatDoesNotFit) {
  Runner runner;
  std::uint8_t seq = 0;
  JobCheck check({});
  const std::vector<std::uint8_t> program(KB_PAYLOAD_MAX - KB_CHECK_LEN, KB_OP_MOVE);
  while (fakeQueueFree() >= program.size()) runner.ask(check.data(++seq, program));
  ++seq;
  EXPECT_EQ(runner.ask(check.data(seq, program)), frame(KB_NAK, seq, {KB_NAK_FULL}));
}

}  // namespace
}  // namespace kerfbench::controller_test
