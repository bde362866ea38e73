// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/source/gpio/line_request.h"

namespace kerfbench::source {

/// An edge in its place.
struct LineEdge {
  std::uint64_t stamp_ns{};  ///< Ascends; equal stamps are of different lines.
  std::size_t line{};
  bool level{};
  bool changed{};  ///< False: the line had this level before; only `gap` is of use.
  bool gap{};      ///< Something before or at this edge is not as it was on the wire: evidence is INVALID.
};

/// Faults of the edges of a request; all zero: none.
struct EdgeFaults {
  std::uint64_t missing{};    ///< Numbers of the request that never came.
  std::uint64_t dropped{};    ///< Edges among them lost by a full buffer: the line's numbers lack too.
  std::uint64_t repeated{};   ///< Edges to the level that the line had already: two became one.
  std::uint64_t backwards{};  ///< Stamps before those of earlier edges.
  std::uint64_t worst_backwards_ns{};
  std::uint64_t late{};      ///< Came when their time had been handed on already.
  std::uint64_t early{};     ///< Stamped before the levels at the start were read.
  std::uint64_t future{};    ///< Stamped later than they were read: another clock.
  std::uint64_t twice{};     ///< Numbers that came twice.
  std::uint64_t first_ns{};  ///< Stamp of the edge at which the first of all was noticed.
};

/// Brings the edges of one request into the order in which they happened, and notices when some are not
/// there. Pure: no device, no clock of its own.
///
/// Each line has an interrupt thread, so edges of two lines can reach the buffer in the wrong order; the
/// numbers of the request tell the right one. A number that is missing may still come, until kHold_ns have
/// passed since the edge behind it was read.
class EdgeOrder {
 public:
  /// A thread of the kernel that is later than this is taken for a loss; what comes later still is `late`.
  static constexpr std::uint64_t kHold_ns = 20'000'000;
  /// Two processors take stamp and number each for themselves, so stamps of two lines can go back a little
  /// against the numbers. Up to this the later edge gets the earlier's stamp; beyond it is a fault.
  static constexpr std::uint64_t kRace_ns = 1'000;

  /// `levels` of the lines at `begin_ns`.
  EdgeOrder(std::vector<bool> levels, std::uint64_t begin_ns);

  /// Edges as they were read at `now_ns`.
  void add(const std::vector<KernelEdge>& edges, std::uint64_t now_ns);
  /// Appends the edges whose place is certain and whose stamp is <= until_ns.
  void take(std::uint64_t now_ns, std::uint64_t until_ns, std::vector<LineEdge>& edges);
  /// Takes all remaining edges: what is missing now will not come.
  void takeAll(std::vector<LineEdge>& edges);

  [[nodiscard]] const EdgeFaults& faults() const { return faults_; }
  /// Faults in words, a sentence for each kind; empty if there is none.
  [[nodiscard]] std::vector<std::string> problems() const;
  /// Levels after the edges that were put in their place.
  [[nodiscard]] const std::vector<bool>& levels() const { return levels_; }
  [[nodiscard]] std::uint64_t edges() const { return placed_; }

 private:
  struct Waiting {
    KernelEdge edge;
    std::uint64_t read_ns{};
  };
  void place(std::uint64_t now_ns, bool last);
  void put(const KernelEdge& edge);
  bool count(std::uint64_t& fault, std::uint64_t stamp_ns, std::uint64_t by = 1);
  /// The stamp as it is handed on.
  std::uint64_t checkStamp(const KernelEdge& edge, bool& gap);

  std::vector<bool> levels_;
  std::vector<std::uint32_t> line_seqno_;
  std::vector<std::uint64_t> line_stamp_ns_;
  std::uint64_t begin_ns_;
  std::uint64_t handed_ns_;  ///< Nothing at or before this may follow.
  std::uint64_t stamp_ns_;   ///< Stamp of the last edge placed.
  std::uint32_t next_{1};
  bool gap_{};
  std::uint64_t placed_{};
  bool any_fault_{};
  EdgeFaults faults_;
  std::vector<Waiting> waiting_;  ///< Edges that wait, by number.
  std::vector<LineEdge> ready_;   ///< Edges in order that are not yet handed on.
};

}  // namespace kerfbench::source
