// SPDX-License-Identifier: Apache-2.0
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
  auto bytes = frame(KB_DATA, 1, {KB_OP_MOVE | 1, 5, KB_OP_END});
  bytes[5] ^= 0x10;
  EXPECT_EQ(runner.ask(bytes), frame(KB_NAK, 1, {KB_NAK_CRC}));
  EXPECT_EQ(fakeQueueFree(), KB_QUEUE_SIZE - 1);
}

TEST(Frame, ARepeatedFrameIsAnsweredButNotExecutedTwice) {
  Runner runner;
  const auto bytes = frame(KB_DATA, 1, {KB_OP_MOVE | 1, 5});
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
  EXPECT_EQ(runner.ask(frame(KB_START, 1)), frame(KB_NAK, 1, {KB_NAK_STATE}));
  EXPECT_EQ(runner.ask(frame(0x55, 2)), frame(KB_NAK, 2, {KB_NAK_TYPE}));
  EXPECT_EQ(runner.ask(frame(KB_CONFIG, 3, config(0, 0, 100))), frame(KB_NAK, 3, {KB_NAK_VALUE}));
  EXPECT_EQ(runner.ask(frame(KB_HELLO, 4, {1})), frame(KB_NAK, 4, {KB_NAK_LENGTH}));
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
  EXPECT_TRUE(answer({{10, 4}})) << "the laser's gate is no pin of an axis";
  EXPECT_TRUE(answer({{11, 1}})) << "held for no tick";
  EXPECT_TRUE(answer({{11, 1}, {12, 1}})) << "a pulse in each tick, held for one";
  EXPECT_FALSE(answer({{11, 1}, {12, 1}, {13, 16}, {18, 16}}));
  EXPECT_TRUE(answer({{11, 1}, {12, 1}, {13, 17}, {18, 16}}));
  EXPECT_TRUE(answer({{11, 1}, {12, KB_WIDE_TICKS_MAX + 1}, {13, 1}, {18, 1}}));
  EXPECT_TRUE(answer({{11, 0x20}, {12, 1}})) << "no such axis";
  EXPECT_TRUE(answer({{14, 32}})) << "more steps than ticks";
  EXPECT_TRUE(answer({{14, 8}})) << "it turns at 31, but never makes them";
}

TEST(Frame, RefusesDataThatDoesNotFit) {
  Runner runner;
  std::uint8_t seq = 0;
  const std::vector<std::uint8_t> payload(KB_PAYLOAD_MAX, KB_OP_MOVE);
  while (fakeQueueFree() >= KB_PAYLOAD_MAX) runner.ask(frame(KB_DATA, ++seq, payload));
  ++seq;
  EXPECT_EQ(runner.ask(frame(KB_DATA, seq, payload)), frame(KB_NAK, seq, {KB_NAK_FULL}));
}

}  // namespace
}  // namespace kerfbench::controller_test
