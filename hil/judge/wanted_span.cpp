// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/wanted_span.h"

#include <algorithm>
#include <limits>

namespace kerfbench::judge {

void WantedSpan::add(std::span<const PinEvent> events, Tick until) {
  for (const PinEvent& event : events) {
    if (!gate_.take(event)) continue;
    const double time_s = rate_.seconds(event.tick);
    if (!first_on_s_) first_on_s_ = time_s;
    if (!gate_.isActive()) last_off_s_ = time_s;
  }
  now_s_ = rate_.seconds(until);
}

inspect::Span WantedSpan::soFar() const {
  if (!first_on_s_) return {now_s_ - margin_s_, -std::numeric_limits<double>::infinity()};
  const double known_s = now_s_ - lag_s_;
  return {*first_on_s_ - margin_s_, gate_.isActive() ? known_s : std::min(known_s, last_off_s_ + margin_s_)};
}

std::optional<inspect::Span> WantedSpan::inAll() const {
  if (!first_on_s_) return std::nullopt;
  return inspect::Span{*first_on_s_ - margin_s_, (gate_.isActive() ? now_s_ : last_off_s_) + margin_s_};
}

}  // namespace kerfbench::judge
