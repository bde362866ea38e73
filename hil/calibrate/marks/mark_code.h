// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bitset>
#include <optional>
#include <span>

namespace kerfbench::calibrate {

/// Ticks of a field mark tell its number. There are 36 slots, nine in each quadrant of the mark (FieldMark in
/// mark_pattern.h says where), and every mark has five ticks.
inline constexpr int kMarkSlots = 36;
inline constexpr int kMarkTicks = 5;
/// Numbers are 0 … kMarkNumbers - 1: 33 x 33 and some more.
inline constexpr int kMarkNumbers = 1120;

using MarkWord = std::bitset<kMarkSlots>;

/// One of the eight ways in which a square can be laid onto itself: first mirrored at the y axis (x -> -x) or
/// not, then turned counter-clockwise by quarters.
struct MarkTurn {
  bool mirrored{};
  int quarters{};  ///< 0 … 3
  bool operator==(const MarkTurn&) const = default;
};
std::span<const MarkTurn, 8> markTurns();

/// Word as seen when a mark was laid down turned.
MarkWord turned(const MarkWord& word, const MarkTurn& turn);

/// The ticks of a number. Of all numbers, in all eight ways of lying, no two words share more than three
/// slots: at least two ticks would have to move to make one out of the other. As each has five ticks, any
/// number of ticks that only vanish, or only are added, never make another word either.
///
/// The book is the lexicographic code: words in the order of their slots, each taken if it fits to all
/// before. @throws std::out_of_range for no number.
const MarkWord& markWord(int number);

struct MarkReading {
  int number{};
  MarkTurn turn;  ///< Turn in which the mark lies.
};
/// nullopt for whatever is no word.
std::optional<MarkReading> readWord(const MarkWord& word);

}  // namespace kerfbench::calibrate
