// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_code.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "hil/calibrate/marks/mark_pattern.h"

namespace kerfbench::calibrate {
namespace {

constexpr int kColumns = static_cast<int>(kSlot.size());
constexpr int kQuadrant = kColumns * kColumns;
static_assert(4 * kQuadrant == kMarkSlots);

constexpr std::array<MarkTurn, 8> kTurns{
    {{false, 0}, {false, 1}, {false, 2}, {false, 3}, {true, 0}, {true, 1}, {true, 2}, {true, 3}}};

/// Slot q * 9 + 3 * j + i is that of column i and row j of the first quadrant, turned by q quarters.
int slotAfter(int slot, const MarkTurn& turn) {
  int quadrant = slot / kQuadrant;
  int i = slot % kColumns;
  int j = slot % kQuadrant / kColumns;
  if (turn.mirrored) {
    // x -> -x brings the first quadrant to the second, where x runs down along its own columns.
    quadrant = (5 - quadrant) % 4;
    std::swap(i, j);
  }
  quadrant = (quadrant + turn.quarters) % 4;
  return quadrant * kQuadrant + kColumns * j + i;
}

using Slots = std::array<int, kMarkTicks>;

MarkWord wordOf(const Slots& slots) {
  MarkWord word;
  for (const int slot : slots) word.set(static_cast<std::size_t>(slot));
  return word;
}

/// The words that share all but one tick: two words with one of these in common differ by one tick only.
std::array<std::uint64_t, kMarkTicks> withoutOne(const MarkWord& word) {
  std::array<std::uint64_t, kMarkTicks> rest{};
  std::size_t n = 0;
  for (std::size_t slot = 0; slot < kMarkSlots; ++slot) {
    if (!word.test(slot)) continue;
    MarkWord less = word;
    rest.at(n++) = less.reset(slot).to_ullong();
  }
  return rest;
}

/// The next choice of slots in lexicographic order; false after the last.
bool advance(Slots& slots) {
  for (int i = kMarkTicks - 1; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    if (slots.at(at) >= kMarkSlots - kMarkTicks + i) continue;
    ++slots.at(at);
    for (std::size_t k = at + 1; k < slots.size(); ++k) slots.at(k) = slots.at(k - 1) + 1;
    return true;
  }
  return false;
}

class Book {
 public:
  Book() {
    Slots slots{};
    for (int i = 0; i < kMarkTicks; ++i) slots.at(static_cast<std::size_t>(i)) = i;
    do take(wordOf(slots));
    while (static_cast<int>(words_.size()) < kMarkNumbers && advance(slots));
    if (static_cast<int>(words_.size()) < kMarkNumbers) throw std::logic_error("field marks: too few words");
  }

  [[nodiscard]] const MarkWord& word(int number) const { return words_.at(static_cast<std::size_t>(number)); }
  [[nodiscard]] std::optional<MarkReading> read(const MarkWord& word) const {
    const auto found = readings_.find(word.to_ullong());
    if (found == readings_.end()) return std::nullopt;
    return found->second;
  }

 private:
  void take(const MarkWord& word) {
    std::vector<std::uint64_t> rests;
    for (const MarkTurn& turn : kTurns) {
      for (const std::uint64_t rest : withoutOne(turned(word, turn))) {
        if (taken_.contains(rest)) return;
        rests.push_back(rest);
      }
    }
    std::sort(rests.begin(), rests.end());
    if (std::adjacent_find(rests.begin(), rests.end()) != rests.end())
      return;  // Refusal of a word that is too similar to itself when turned.
    taken_.insert(rests.begin(), rests.end());
    const int number = static_cast<int>(words_.size());
    for (const MarkTurn& turn : kTurns) readings_[turned(word, turn).to_ullong()] = {number, turn};
    words_.push_back(word);
  }

  std::vector<MarkWord> words_;
  std::unordered_map<std::uint64_t, MarkReading> readings_;
  std::unordered_set<std::uint64_t> taken_;
};

const Book& book() {
  static const Book the_book;
  return the_book;
}

}  // namespace

std::span<const MarkTurn, 8> markTurns() { return kTurns; }

MarkWord turned(const MarkWord& word, const MarkTurn& turn) {
  MarkWord out;
  for (int slot = 0; slot < kMarkSlots; ++slot) {
    if (word.test(static_cast<std::size_t>(slot))) out.set(static_cast<std::size_t>(slotAfter(slot, turn)));
  }
  return out;
}

const MarkWord& markWord(int number) {
  if (number < 0 || number >= kMarkNumbers)
    throw std::out_of_range("field marks: no number " + std::to_string(number));
  return book().word(number);
}

std::optional<MarkReading> readWord(const MarkWord& word) { return book().read(word); }

}  // namespace kerfbench::calibrate
