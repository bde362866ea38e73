// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/edge_player.h"

#include <algorithm>
#include <utility>

namespace kerfbench::source {

EdgePlayer::EdgePlayer(std::shared_ptr<GpioSystem> system, OutputLines lines)
    : system_(std::move(system)), lines_(std::move(lines)), last_due_(lines_.lines().size()) {}

void EdgePlayer::plan(std::size_t line, bool level, std::uint64_t at_ns) {
  std::uint64_t& last_ns = last_due_.at(line);
  const std::uint64_t due_ns = std::max(at_ns, last_ns + 1);
  last_ns = due_ns;
  const auto place = std::ranges::upper_bound(planned_, due_ns, {}, &Planned::due_ns);
  planned_.insert(place, {due_ns, at_ns, line, level});
}

void EdgePlayer::play(std::vector<PlayedEdge>& played) {
  std::vector<OutputLines::Change> changes;
  while (!planned_.empty() && planned_.front().due_ns <= system_->now_ns()) {
    // What is planned for one instant is put out in one call; what is late is not: it would be lost.
    const std::uint64_t due_ns = planned_.front().due_ns;
    const auto end = std::ranges::upper_bound(planned_, due_ns, {}, &Planned::due_ns);
    changes.clear();
    for (auto edge = planned_.begin(); edge != end; ++edge) changes.push_back({edge->line, edge->level});
    lines_.set(changes);
    last_put_ns_ = std::max(system_->now_ns(), last_put_ns_ + 1);
    for (auto edge = planned_.begin(); edge != end; ++edge)
      played.push_back({edge->line, edge->level, edge->wished_ns, last_put_ns_});
    planned_.erase(planned_.begin(), end);
  }
}

}  // namespace kerfbench::source
