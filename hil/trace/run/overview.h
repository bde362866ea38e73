// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "hil/trace/json_text.h"
#include "hil/trace/topics.h"

namespace kerfbench::trace {

/// Least and most of a column, and edges and last level of each signal, for intervals of a tenth of a second
/// and longer: /overview/….
class Overview {
 public:
  /// Topic, begin of the first row, message.
  using Sink = std::function<void(Topic topic, double from_s, const std::string& json)>;
  Overview(std::vector<std::string> columns, std::size_t signals, Sink sink);

  /// An edge of the quantum whose row follows.
  void addEdge(int id, bool level);
  /// Values of the columns at the end of a quantum, by time; NaN: not known. `lit_s`: the laser was lit for
  /// so long in it.
  void addRow(double time_s, const std::vector<double>& values, double lit_s);
  void end();

 private:
  struct Row {
    std::vector<double> least, most;
    std::vector<std::uint32_t> edges;
    std::vector<bool> levels;
    double lit_s{};
    bool empty{true};
  };
  struct Level {
    Topic topic{};
    double step_s{};
    std::int64_t index{};  ///< Index of the row in the making.
    Row row;
    std::int64_t first{};  ///< Index of the message's first row.
    int rows{};
    std::vector<JsonColumn> least, most, edges, levels;
    JsonColumn lit;
  };
  [[nodiscard]] Row emptyRow() const;
  static void merge(const Row& from, Row& into);
  void advance(Level& level, std::int64_t index);
  void finishRow(Level& level);
  void finishMessage(Level& level);

  std::vector<std::string> columns_;
  std::size_t signals_;
  Sink sink_;
  Row quantum_;
  std::vector<Level> levels_;
};

}  // namespace kerfbench::trace
