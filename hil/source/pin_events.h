// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <span>
#include <vector>

#include "hil/base/spilled_vector.h"
#include "twin/base/pin_event.h"

namespace kerfbench::source {

/// Events of pins, to be read in order, packed: nearly all take 4 bytes instead of 16, because the machine's
/// pins change in few ways. What does not fit into memory is in a temporary file (base::SpilledVector), whose
/// memory is given back behind whoever reads it. Any events are kept as they are, sorted or not. One that was
/// moved from may be destroyed or assigned to, and nothing else.
///
/// A word of 32 bits is the code of a change (its port and bits) above the ticks since the event before it.
/// An event that is further away takes two words; one that is no plain change of known bits takes five.
class PinEvents {
 public:
  class Iterator;
  using value_type = PinEvent;
  using size_type = std::size_t;
  using difference_type = std::ptrdiff_t;
  using reference = PinEvent;
  using const_reference = PinEvent;
  using iterator = Iterator;
  using const_iterator = Iterator;

  PinEvents() { codes_of_.fill(kWhole); }
  PinEvents(std::initializer_list<PinEvent> events) : PinEvents(std::span(events.begin(), events.size())) {}
  explicit PinEvents(std::span<const PinEvent> events) : PinEvents() { append(events); }
  explicit PinEvents(const std::vector<PinEvent>& events) : PinEvents(std::span(events)) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// Bytes that the events take.
  [[nodiscard]] std::size_t bytes() const { return words_.size() * sizeof(std::uint32_t); }
  /// The first event, and the last one; of none, an event of zeros.
  [[nodiscard]] PinEvent front() const;
  [[nodiscard]] const PinEvent& back() const { return last_; }
  /// Levels of a port after its last event; all low without one.
  [[nodiscard]] std::uint16_t levelsOf(std::uint16_t port) const {
    return port < levels_.size() ? levels_[port] : std::uint16_t{0};
  }

  /// @throws as base::SpilledVector::push_back(); the events end there then.
  void push_back(PinEvent event) {
    const Tick ticks = event.tick - last_.tick;  // Beyond all that is packed where time goes back.
    const unsigned code = codeOf(event);
    if (ticks <= kMostNear && code < kFar) [[likely]] {
      words_.push_back(code << kTickBits | static_cast<std::uint32_t>(ticks));
      levels_[event.port] = event.level;
    } else {
      pushRare(event, ticks, code);
    }
    last_ = event;
    ++size_;
  }
  void append(std::span<const PinEvent> events) {
    for (const PinEvent& event : events) push_back(event);
  }
  void clear() { *this = PinEvents(); }
  /// Room in memory for so many events that are packed; see base::SpilledVector::holdInMemory().
  void holdInMemory(std::size_t count) { words_.holdInMemory(2 * count); }

  /// Reading again is allowed, and reading by several threads. Iterators end when something is appended.
  [[nodiscard]] Iterator begin() const;
  [[nodiscard]] Iterator end() const;

  /// All of them as they are; for few.
  [[nodiscard]] std::vector<PinEvent> unpacked() const;

  friend bool operator==(const PinEvents& a, const PinEvents& b);
  friend bool operator==(const PinEvents& a, const std::vector<PinEvent>& b);

 private:
  static constexpr unsigned kTickBits = 24;
  static constexpr Tick kMostNear = (Tick{1} << kTickBits) - 1;
  static constexpr Tick kMostFar = (Tick{1} << (2 * kTickBits)) - 1;
  static constexpr unsigned kFar = 254;    ///< The upper bits of the ticks, for the word that follows.
  static constexpr unsigned kWhole = 255;  ///< Four words follow, which are the event.
  static constexpr std::size_t kWordsOfAnEvent = sizeof(PinEvent) / sizeof(std::uint32_t);

  /// Bits of a port that change together.
  struct Change {
    std::uint16_t port{};
    std::uint16_t bits{};
    friend bool operator==(const Change&, const Change&) = default;
  };
  static std::size_t slotOf(const Change& change) {
    return (change.bits ^ change.bits >> 7U ^ change.port * 37U) & 255U;
  }
  /// Code of an event that turns bits of its port over; kWhole for any other.
  [[nodiscard]] unsigned codeOf(PinEvent event) {
    const Change change{event.port, event.changed};
    unsigned code = codes_of_[slotOf(change)];
    if (code == kWhole || changes_[code] != change) [[unlikely]]
      code = learn(change);
    const bool is_plain = event.flags == 0 && (levelsOf(event.port) ^ event.changed) == event.level;
    return is_plain ? code : kWhole;
  }
  unsigned learn(const Change& change);
  void pushRare(PinEvent event, Tick ticks, unsigned code);

  base::SpilledVector<std::uint32_t> words_;
  std::size_t size_{};
  PinEvent last_{};
  std::vector<std::uint16_t> levels_;         ///< Levels of each port after its last event.
  std::vector<Change> changes_;               ///< Change of each code, in the order in which they came.
  std::array<std::uint8_t, 256> codes_of_{};  ///< A code that was found last in each slot, or kWhole.
};

/// Makes events of words again, one after the other.
class PinEvents::Iterator {
 public:
  using value_type = PinEvent;
  using difference_type = std::ptrdiff_t;
  using reference = PinEvent;
  using pointer = const PinEvent*;
  using iterator_category = std::input_iterator_tag;
  using iterator_concept = std::forward_iterator_tag;

  Iterator() = default;

  PinEvent operator*() const { return event_; }
  const PinEvent* operator->() const { return &event_; }
  Iterator& operator++() {
    if (--left_ > 0) read();
    return *this;
  }
  Iterator operator++(int) {
    Iterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Iterator& a, const Iterator& b) { return a.left_ == b.left_; }

 private:
  friend class PinEvents;
  explicit Iterator(const PinEvents& all);

  void read() {
    if (at_ >= stride_end_) [[unlikely]]
      passStride();
    const std::uint32_t word = *at_++;
    const unsigned code = word >> kTickBits;
    if (code >= kFar) [[unlikely]]
      return readRare(word);
    turn(code, word & kMostNear);
  }
  void turn(unsigned code, Tick ticks) {
    const Change change = changes_[code];
    event_.tick += ticks;
    event_.port = change.port;
    event_.changed = change.bits;
    event_.level = levels_[change.port] ^= change.bits;
    event_.flags = PinEvent::kNone;
  }
  void readRare(std::uint32_t word);
  /// Gives back what was read.
  void passStride();

  const base::SpilledVector<std::uint32_t>* words_{};
  const Change* changes_{};
  const std::uint32_t* at_{};
  const std::uint32_t* stride_end_{};
  std::size_t left_{};  ///< Events from this one to the last.
  PinEvent event_{};
  std::vector<std::uint16_t> levels_;
};

inline PinEvents::Iterator PinEvents::begin() const { return Iterator(*this); }
inline PinEvents::Iterator PinEvents::end() const { return {}; }
inline std::vector<PinEvent> PinEvents::unpacked() const { return {begin(), end()}; }
inline PinEvent PinEvents::front() const { return empty() ? PinEvent{} : *begin(); }

}  // namespace kerfbench::source
