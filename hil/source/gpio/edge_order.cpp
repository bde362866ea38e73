// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/edge_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace kerfbench::source {
namespace {

/// Numbers are 32 bits and wrap.
std::int32_t ahead(std::uint32_t seqno, std::uint32_t of) { return static_cast<std::int32_t>(seqno - of); }

}  // namespace

EdgeOrder::EdgeOrder(std::vector<bool> levels, std::uint64_t begin_ns)
    : levels_(std::move(levels)),
      line_seqno_(levels_.size()),
      line_stamp_ns_(levels_.size(), begin_ns),
      begin_ns_(begin_ns),
      handed_ns_(begin_ns),
      stamp_ns_(begin_ns) {}

void EdgeOrder::add(const std::vector<KernelEdge>& edges, std::uint64_t now_ns) {
  for (const KernelEdge& edge : edges) {
    if (ahead(edge.seqno, next_) < 0) {
      gap_ = count(faults_.twice, edge.stamp_ns);
      continue;
    }
    if (edge.stamp_ns > now_ns) gap_ = count(faults_.future, edge.stamp_ns);
    const auto place = std::ranges::lower_bound(
        waiting_, edge.seqno, [](std::uint32_t a, std::uint32_t b) { return ahead(a, b) < 0; },
        [](const Waiting& w) { return w.edge.seqno; });
    if (place != waiting_.end() && place->edge.seqno == edge.seqno) {
      gap_ = count(faults_.twice, edge.stamp_ns);
      continue;
    }
    waiting_.insert(place, {edge, now_ns});
  }
}

void EdgeOrder::take(std::uint64_t now_ns, std::uint64_t until_ns, std::vector<LineEdge>& edges) {
  place(now_ns, false);
  const auto end = std::ranges::upper_bound(ready_, until_ns, {}, &LineEdge::stamp_ns);
  edges.insert(edges.end(), ready_.begin(), end);
  ready_.erase(ready_.begin(), end);
  handed_ns_ = std::max(handed_ns_, until_ns);
}

void EdgeOrder::takeAll(std::vector<LineEdge>& edges) {
  place(0, true);
  edges.insert(edges.end(), ready_.begin(), ready_.end());
  ready_.clear();
}

/// Places the edges at the front whose numbers follow on each other, and those behind a gap whose wait is
/// over.
void EdgeOrder::place(std::uint64_t now_ns, bool last) {
  auto at = waiting_.begin();
  for (; at != waiting_.end(); ++at) {
    if (at->edge.seqno != next_) {
      if (!last && now_ns < at->read_ns + kHold_ns) break;
      gap_ = count(faults_.missing, at->edge.stamp_ns, at->edge.seqno - next_);
    }
    put(at->edge);
    next_ = at->edge.seqno + 1;
  }
  waiting_.erase(waiting_.begin(), at);
}

void EdgeOrder::put(const KernelEdge& edge) {
  bool gap = std::exchange(gap_, false);
  std::uint32_t& line_seqno = line_seqno_[edge.line];
  const std::int32_t step = ahead(edge.line_seqno, line_seqno + 1);
  if (step > 0) gap = count(faults_.dropped, edge.stamp_ns, static_cast<std::uint64_t>(step));
  if (step < 0) gap = count(faults_.twice, edge.stamp_ns);
  line_seqno = edge.line_seqno;
  const bool changed = levels_[edge.line] != edge.level;
  if (!changed) gap = count(faults_.repeated, edge.stamp_ns);
  levels_[edge.line] = edge.level;
  const std::uint64_t stamp_ns = checkStamp(edge, gap);
  ready_.push_back({stamp_ns, edge.line, edge.level, changed, gap});
  ++placed_;
}

std::uint64_t EdgeOrder::checkStamp(const KernelEdge& edge, bool& gap) {
  if (edge.stamp_ns <= begin_ns_) {
    gap = count(faults_.early, edge.stamp_ns);
  } else if (edge.stamp_ns <= handed_ns_) {
    gap = count(faults_.late, edge.stamp_ns);
  }
  const std::uint64_t stamp_ns = std::max({edge.stamp_ns, stamp_ns_, handed_ns_ + 1});
  const bool same_line = stamp_ns <= line_stamp_ns_[edge.line];
  const std::uint64_t back_ns = stamp_ns_ - std::min(edge.stamp_ns, stamp_ns_);
  if (same_line || back_ns > kRace_ns) {
    gap = count(faults_.backwards, edge.stamp_ns);
    faults_.worst_backwards_ns = std::max(faults_.worst_backwards_ns, back_ns);
  }
  // One wire cannot change twice at one stamp.
  stamp_ns_ = same_line ? stamp_ns + 1 : stamp_ns;
  line_stamp_ns_[edge.line] = stamp_ns_;
  return stamp_ns_;
}

bool EdgeOrder::count(std::uint64_t& fault, std::uint64_t stamp_ns, std::uint64_t by) {
  fault += by;
  if (!std::exchange(any_fault_, true)) faults_.first_ns = stamp_ns;
  return true;
}

std::vector<std::string> EdgeOrder::problems() const {
  std::vector<std::string> words;
  const std::uint64_t merged = faults_.missing > faults_.dropped ? faults_.missing - faults_.dropped : 0;
  const auto tell = [&](std::uint64_t number, const char* what) {
    if (number > 0) words.push_back(fmt::format("{} edge{} {}", number, number == 1 ? "" : "s", what));
  };
  tell(
      faults_.dropped,
      "lost because the kernel's buffer was full: the bench read too late (real-time priority? other load?)");
  tell(merged,
       "lost in the kernel before they were read: they came faster than its interrupt thread takes them");
  tell(faults_.repeated, "to a level that the line had already: two or more edges were merged into one");
  if (faults_.backwards > 0) {
    words.push_back(fmt::format("{} time stamps went back against the order of the edges, by up to {} ns",
                                faults_.backwards, faults_.worst_backwards_ns));
  }
  tell(faults_.late, "came later than the kernel's threads may be");
  tell(faults_.early, "came while the lines were being taken over: start the bench before the controller");
  tell(faults_.future, "stamped later than read: the kernel does not stamp by CLOCK_MONOTONIC");
  tell(faults_.twice, "told twice, or long after their time");
  return words;
}

}  // namespace kerfbench::source
