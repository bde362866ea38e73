// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hil/serve/answer.h"

namespace kerfbench::serve {

/// What there is to tell of a run, kept for those that come later. Events have numbers from 1 on. Of those
/// that say how something stands now, only the last is kept; of lines the last kMostKept. May be used by
/// several threads.
class EventStream {
 public:
  /// Lines of a log that a client which comes later is told.
  static constexpr std::size_t kMostKept = 5'000;

  /// `is_standing`: takes the place of the last event of this name.
  void add(const std::string& name, const std::string& json, bool is_standing);
  /// Nothing more comes.
  void end();

  struct Event {
    std::uint64_t number{};
    std::string name, json;
    bool is_standing{};
  };
  /// The first event behind this number; waits for it. nullopt: nothing more comes, or nothing came for
  /// `wait_ms`, which `is_ended` tells apart.
  std::optional<Event> after(std::uint64_t number, int wait_ms, bool& is_ended);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Event> events_;
  std::uint64_t last_{};
  bool ended_{};
};

/// The same as text/event-stream (WHATWG HTML, 9.2), for a client that has had all up to `number`.
std::unique_ptr<AnswerBody> eventBody(std::shared_ptr<EventStream> stream, std::uint64_t number);

}  // namespace kerfbench::serve
