// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_code.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "hil/calibrate/marks/mark_pattern.h"

namespace kerfbench::calibrate {
namespace {

struct Seen {
  MarkWord word;
  MarkReading reading;
};

std::vector<Seen> allWords() {
  std::vector<Seen> words;
  for (int number = 0; number < kMarkNumbers; ++number) {
    for (const MarkTurn& turn : markTurns())
      words.push_back({turned(markWord(number), turn), {number, turn}});
  }
  return words;
}

TEST(MarkCode, EveryNumberIsReadInEveryWayOfLying) {
  for (const Seen& seen : allWords()) {
    ASSERT_EQ(seen.word.count(), static_cast<std::size_t>(kMarkTicks));
    const auto reading = readWord(seen.word);
    ASSERT_TRUE(reading);
    ASSERT_EQ(reading->number, seen.reading.number);
    ASSERT_EQ(reading->turn, seen.reading.turn);
  }
}

TEST(MarkCode, OneTickErasedOrAddedIsNeverAnotherMark) {
  for (const Seen& seen : allWords()) {
    for (std::size_t slot = 0; slot < kMarkSlots; ++slot) {
      MarkWord other = seen.word;
      ASSERT_FALSE(readWord(other.flip(slot))) << seen.reading.number << " slot " << slot;
    }
  }
}

// The code must hold whatever part of a mark is covered, and however much dust lies on it.
TEST(MarkCode, AnyTicksErasedOrAnyTwoAddedAreNeverAnotherMark) {
  for (const Seen& seen : allWords()) {
    std::vector<std::size_t> ticks;
    for (std::size_t slot = 0; slot < kMarkSlots; ++slot) {
      if (seen.word.test(slot)) ticks.push_back(slot);
    }
    for (unsigned erased = 1; erased < (1U << kMarkTicks); ++erased) {
      MarkWord rest = seen.word;
      for (std::size_t k = 0; k < ticks.size(); ++k) {
        if (((erased >> k) & 1U) != 0U) rest.reset(ticks[k]);
      }
      ASSERT_FALSE(readWord(rest));
    }
  }
  for (int number = 0; number < kMarkNumbers; ++number) {
    for (std::size_t a = 0; a < kMarkSlots; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        MarkWord more = markWord(number);
        more.set(a).set(b);
        ASSERT_TRUE(more == markWord(number) || !readWord(more));
      }
    }
  }
}

TEST(MarkCode, OneTickMovedIsNeverAnotherMark) {
  const std::vector<Seen> words = allWords();
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GE((words[i].word ^ words[j].word).count(), 4U)
          << words[i].reading.number << " and " << words[j].reading.number;
    }
  }
}

// The permutation of slots is that of their places.
TEST(MarkCode, ATurnedWordHasItsTicksAtTurnedPlaces) {
  for (const MarkTurn& turn : markTurns()) {
    for (int slot = 0; slot < kMarkSlots; ++slot) {
      Eigen::Vector2d expected = slotCentre(slot);
      if (turn.mirrored) expected.x() = -expected.x();
      for (int q = 0; q < turn.quarters; ++q) expected = Eigen::Vector2d(-expected.y(), expected.x());
      MarkWord word;
      word.set(static_cast<std::size_t>(slot));
      const MarkWord after = turned(word, turn);
      ASSERT_EQ(after.count(), 1U);
      for (int other = 0; other < kMarkSlots; ++other) {
        if (!after.test(static_cast<std::size_t>(other))) continue;
        EXPECT_LT((slotCentre(other) - expected).norm(), 1e-12) << "slot " << slot;
      }
    }
  }
}

TEST(MarkCode, NoOtherNumbersThanItsOwn) {
  EXPECT_THROW(static_cast<void>(markWord(-1)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(markWord(kMarkNumbers)), std::out_of_range);
}

}  // namespace
}  // namespace kerfbench::calibrate
