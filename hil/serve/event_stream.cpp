// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/event_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace kerfbench::serve {
namespace {

/// So often it is looked whether the client is still there.
constexpr int kLookAround_ms = 200;
/// A line that says nothing is sent when there was nothing to say for so long, so that a client that went
/// without a word is noticed.
constexpr int kLooksBetweenComments = 50;

class EventBody final : public AnswerBody {
 public:
  EventBody(std::shared_ptr<EventStream> stream, std::uint64_t number)
      : stream_(std::move(stream)), number_(number) {}

  std::optional<std::string> next(const std::function<bool()>& is_gone) override {
    for (int looks = 0; !is_gone(); ++looks) {
      bool is_ended = false;
      if (const auto event = stream_->after(number_, kLookAround_ms, is_ended)) {
        number_ = event->number;
        return fmt::format("id: {}\nevent: {}\ndata: {}\n\n", event->number, event->name, event->json);
      }
      if (is_ended && std::exchange(said_end_, true)) return std::nullopt;
      // A client connects anew when the line ends, unless it knows that all is said.
      if (is_ended) return std::string("event: end\ndata: {}\n\n");
      if (looks >= kLooksBetweenComments) return std::string(": still here\n\n");
    }
    return std::nullopt;
  }

 private:
  std::shared_ptr<EventStream> stream_;
  std::uint64_t number_;
  bool said_end_{};
};

}  // namespace

void EventStream::add(const std::string& name, const std::string& json, bool is_standing) {
  const std::lock_guard lock(mutex_);
  if (is_standing) {
    const auto old = std::ranges::find_if(
        events_, [&name](const Event& event) { return event.is_standing && event.name == name; });
    if (old != events_.end()) events_.erase(old);
  } else if (events_.size() >= kMostKept) {
    const auto line = std::ranges::find_if(events_, [](const Event& event) { return !event.is_standing; });
    if (line != events_.end()) events_.erase(line);
  }
  events_.push_back({++last_, name, json, is_standing});
  changed_.notify_all();
}

void EventStream::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

std::optional<EventStream::Event> EventStream::after(std::uint64_t number, int wait_ms, bool& is_ended) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::milliseconds(wait_ms), [&] { return last_ > number || ended_; });
  const auto next =
      std::ranges::lower_bound(events_, number + 1, {}, [](const Event& event) { return event.number; });
  is_ended = ended_ && next == events_.end();
  if (next == events_.end()) return std::nullopt;
  return *next;
}

std::unique_ptr<AnswerBody> eventBody(std::shared_ptr<EventStream> stream, std::uint64_t number) {
  return std::make_unique<EventBody>(std::move(stream), number);
}

}  // namespace kerfbench::serve
