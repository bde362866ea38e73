// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/overview.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/trace/run/motion_batch.h"

namespace kerfbench::trace {
namespace {

// A quantum that ends at the end of an interval belongs to it, however its time was rounded.
constexpr double kRounding_s = 1e-7;

void appendPair(std::string& text, const char* first, const JsonColumn& a, const char* second,
                const JsonColumn& b) {
  text.push_back('{');
  appendColumn(text, first, a);
  appendColumn(text, second, b);
  text.push_back('}');
}

}  // namespace

Overview::Overview(std::vector<std::string> columns, std::size_t signals, Sink sink)
    : columns_(std::move(columns)), signals_(signals), sink_(std::move(sink)), quantum_(emptyRow()) {
  for (std::size_t i = 0; i < kOverviewSteps_s.size(); ++i) {
    Level level;
    level.topic = static_cast<Topic>(static_cast<std::size_t>(Topic::kOverview100ms) + i);
    level.step_s = kOverviewSteps_s.at(i);
    level.row = emptyRow();
    level.least.resize(columns_.size());
    level.most.resize(columns_.size());
    level.edges.resize(signals_);
    level.levels.resize(signals_);
    levels_.push_back(std::move(level));
  }
}

Overview::Row Overview::emptyRow() const {
  Row row;
  row.least.assign(columns_.size(), std::numeric_limits<double>::quiet_NaN());
  row.most = row.least;
  row.edges.assign(signals_, 0);
  row.levels.assign(signals_, false);
  return row;
}

void Overview::addEdge(int id, bool level) {
  const auto index = static_cast<std::size_t>(id);
  ++quantum_.edges[index];
  quantum_.levels[index] = level;
}

void Overview::merge(const Row& from, Row& into) {
  for (std::size_t i = 0; i < from.least.size(); ++i) {
    // fmin and fmax take the number where one is none.
    into.least[i] = std::fmin(into.least[i], from.least[i]);
    into.most[i] = std::fmax(into.most[i], from.most[i]);
  }
  for (std::size_t i = 0; i < from.edges.size(); ++i) into.edges[i] += from.edges[i];
  into.levels = from.levels;
  into.lit_s += from.lit_s;
  into.empty = false;
}

void Overview::addRow(double time_s, const std::vector<double>& values, double lit_s) {
  quantum_.least = values;
  quantum_.most = values;
  quantum_.lit_s = lit_s;
  for (Level& level : levels_) {
    const double place = (time_s - kRounding_s) / level.step_s;
    advance(level, std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(place))));
    merge(quantum_, level.row);
  }
  std::ranges::fill(quantum_.edges, 0U);
}

void Overview::advance(Level& level, std::int64_t index) {
  while (level.index < index) {
    finishRow(level);
    ++level.index;
  }
}

void Overview::finishRow(Level& level) {
  if (level.rows++ == 0) level.first = level.index;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    level.least[i].add(level.row.least[i], decimalsOf(columns_[i]));
    level.most[i].add(level.row.most[i], decimalsOf(columns_[i]));
  }
  for (std::size_t i = 0; i < signals_; ++i) {
    level.edges[i].add(static_cast<std::int64_t>(level.row.edges[i]));
    level.levels[i].add(level.row.levels[i] ? 1 : 0);
  }
  level.lit.add(level.row.lit_s, kSeconds);
  std::vector<bool> kept = level.row.levels;
  level.row = emptyRow();
  level.row.levels = std::move(kept);
  if (level.rows == kOverviewRows) finishMessage(level);
}

void Overview::finishMessage(Level& level) {
  if (level.rows == 0) return;
  const double from_s = static_cast<double>(level.first) * level.step_s;
  std::string text = "{\"from_s\":";
  appendNumber(text, from_s, kSeconds);
  text += ",\"step_s\":";
  appendNumber(text, level.step_s, kSeconds);
  text += ",\"rows\":";
  appendInteger(text, level.rows);
  text += ",\"pins\":[";
  for (std::size_t i = 0; i < signals_; ++i) {
    if (i > 0) text.push_back(',');
    text += "{\"id\":";
    appendInteger(text, static_cast<std::int64_t>(i));
    appendColumn(text, "edges", level.edges[i]);
    appendColumn(text, "level", level.levels[i]);
    text.push_back('}');
    level.edges[i].clear();
    level.levels[i].clear();
  }
  text += "],\"columns\":{";
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (i > 0) text.push_back(',');
    appendQuoted(text, columns_[i]);
    text.push_back(':');
    appendPair(text, "min", level.least[i], "max", level.most[i]);
    level.least[i].clear();
    level.most[i].clear();
  }
  text.push_back('}');
  appendColumn(text, "lit_s", level.lit);
  level.lit.clear();
  text.push_back('}');
  sink_(level.topic, from_s, text);
  level.rows = 0;
}

void Overview::end() {
  for (Level& level : levels_) {
    if (!level.row.empty) finishRow(level);
    finishMessage(level);
  }
}

}  // namespace kerfbench::trace
