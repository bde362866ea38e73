// SPDX-License-Identifier: Apache-2.0
#include "hil/source/pin_events.h"

#include <gmock/gmock.h>

#include <utility>

namespace kerfbench::source {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

std::uint32_t next(std::uint32_t& random) {
  random = random * 1664525U + 1013904223U;
  return random >> 8U;
}

/// Plain changes of a few pins, as of a machine, close together.
std::vector<PinEvent> plainEvents(std::size_t count) {
  std::vector<PinEvent> events;
  std::array<std::uint16_t, 4> levels{};
  std::uint32_t random = 7;
  Tick tick = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto port = static_cast<std::uint16_t>(next(random) % levels.size());
    const auto bits = static_cast<std::uint16_t>(1U << next(random) % 4);
    levels.at(port) ^= bits;
    events.push_back({tick += next(random) % 2000, port, bits, levels.at(port), 0});
  }
  return events;
}

TEST(PinEvents, AreEmptyAtFirst) {
  const PinEvents none;
  EXPECT_TRUE(none.empty());
  EXPECT_THAT(none, IsEmpty());
  EXPECT_EQ(none.begin(), none.end());
  EXPECT_EQ(none.front(), PinEvent{});
  EXPECT_EQ(none.back(), PinEvent{});
  EXPECT_EQ(none.levelsOf(3), 0);
}

TEST(PinEvents, OfAMachineTakeFourBytes) {
  const std::vector<PinEvent> events = plainEvents(5000);
  const PinEvents packed(events);
  EXPECT_THAT(packed, ElementsAreArray(events));
  EXPECT_EQ(packed, events);
  EXPECT_EQ(packed.unpacked(), events);
  EXPECT_EQ(packed.size(), events.size());
  EXPECT_EQ(packed.front(), events.front());
  EXPECT_EQ(packed.back(), events.back());
  EXPECT_EQ(packed.bytes(), 4 * events.size());
}

TEST(PinEvents, KeepWhateverElseThereIs) {
  // Far, farther than packed, back in time, levels that do not follow, marks of gaps, the last port.
  const std::vector<PinEvent> events{{0xFFFFFF, 0, 1, 1, 0},
                                     {0x1FFFFFF, 0, 1, 0, 0},
                                     {0x2000000000000, 0, 1, 1, 0},
                                     {0x3FFFFFFFFFFFF, 0, 1, 0, 0},
                                     {17, 0, 1, 1, 0},
                                     {18, 0, 2, 0xFF, 0},
                                     {19, 0, 1, 0xFE, 0},
                                     {20, 0, 0, 0xFE, PinEvent::kGap},
                                     {20, 65535, 0x8001, 0x8001, 0},
                                     {~Tick{0}, 65535, 0x8001, 0, PinEvent::kGap},
                                     {~Tick{0}, 0, 1, 0xFF, 0}};
  const PinEvents packed(events);
  EXPECT_THAT(packed, ElementsAreArray(events));
  EXPECT_EQ(packed.levelsOf(0), 0xFF);
  EXPECT_EQ(packed.levelsOf(65535), 0);
}

TEST(PinEvents, KeepMoreChangesThanThereAreCodes) {
  std::vector<PinEvent> events;
  std::array<std::uint16_t, 3> levels{};
  std::uint32_t random = 3;
  for (Tick tick = 1; tick < 3000; ++tick) {
    const auto port = static_cast<std::uint16_t>(next(random) % levels.size());
    const auto bits = static_cast<std::uint16_t>(next(random) % 1000);
    levels.at(port) ^= bits;
    events.push_back({tick, port, bits, levels.at(port), 0});
  }
  EXPECT_THAT(PinEvents(events), ElementsAreArray(events));
}

TEST(PinEvents, BeyondTheMemoryAreTheSame) {
  const std::vector<PinEvent> events = plainEvents(3 * base::SpilledBytes::kInMemory / sizeof(std::uint32_t));
  PinEvents packed(events);
  EXPECT_EQ(packed, events);
  PinEvents copy = packed;
  const PinEvent more{events.back().tick + 5, 9, 1, 1, 0};
  copy.push_back(more);
  EXPECT_EQ(packed, events) << "a copy goes its own way";
  EXPECT_EQ(copy.back(), more);
  EXPECT_EQ(copy.size(), events.size() + 1);
  const PinEvents moved = std::move(copy);
  EXPECT_EQ(moved.size(), events.size() + 1);
  packed.clear();
  EXPECT_THAT(packed, IsEmpty());
}

TEST(PinEvents, AreReadFromAnyPlaceAgain) {
  const PinEvents packed{{1, 0, 1, 1, 0}, {2, 0, 1, 0, 0}, {3, 1, 1, 1, 0}};
  auto first = packed.begin();
  const auto mark = ++first;
  EXPECT_EQ(std::vector<PinEvent>(mark, packed.end()), std::vector<PinEvent>(first, packed.end()));
  EXPECT_EQ((first++)->tick, 2U);
  EXPECT_EQ(first->port, 1);
  EXPECT_EQ(++first, packed.end());
  EXPECT_THAT(packed, ElementsAre(PinEvent{1, 0, 1, 1, 0}, PinEvent{2, 0, 1, 0, 0}, PinEvent{3, 1, 1, 1, 0}));
}

}  // namespace
}  // namespace kerfbench::source
