// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/head/correction.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/input_file.h"
#include "hil/base/text.h"

namespace kerfbench::planner {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr std::size_t kLeastNodes = 3;
constexpr std::size_t kMostNodes = 1025;
constexpr std::size_t kMostFaults = 20;
constexpr std::uint64_t kMostBytes = 128U << 20U;
constexpr double kFarthestMm = 1e5;
constexpr double kLargestValue = 1e6;

/// Faults of a file, limited to a readable number.
class Faults {
 public:
  explicit Faults(std::string name) : name_(std::move(name)) {}
  void add(int line, const std::string& what) {
    if (++count_ <= kMostFaults) text_ += fmt::format("{}:{}: {}\n", name_, line, what);
  }
  [[nodiscard]] bool any() const { return count_ > 0; }
  void throwIfAny() const {
    if (!any()) return;
    std::string text = text_;
    if (count_ > kMostFaults) text += fmt::format("{}: and {} more\n", name_, count_ - kMostFaults);
    text.pop_back();
    throw PlanError(text);
  }

 private:
  std::string name_;
  std::string text_;
  std::size_t count_{};
};

struct Row {
  int line{};
  std::array<double, 4> value{};
};

bool readRow(std::string_view text, int line, Faults& faults, Row& row) {
  row.line = line;
  std::size_t count = 0;
  for (std::size_t from = 0; from <= text.size(); ++count) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    std::string_view word = base::trimmed(text.substr(from, to - from));
    from = to + 1;
    if (count >= 4) continue;
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), row.value[count]);
    const double most = count < 2 ? kFarthestMm : kLargestValue;
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(row.value[count])) {
      faults.add(line, base::inQuotes(word) + " is no number");
      return false;
    }
    if (std::abs(row.value[count]) > most) {
      faults.add(line, fmt::format("{:g} is out of all bounds", row.value[count]));
      return false;
    }
  }
  if (count != 4) faults.add(line, fmt::format("a node has 4 numbers, this line has {}", count));
  return count == 4;
}

/// Weights of the derivative at z of the polynomial through the nodes (Fornberg 1988), for one derivative.
std::vector<double> slopeWeights(const std::vector<double>& nodes, std::size_t first, std::size_t count,
                                 double z) {
  std::vector<double> value(count, 0.0);
  std::vector<double> slope(count, 0.0);
  value[0] = 1.0;
  double c1 = 1.0;
  for (std::size_t i = 1; i < count; ++i) {
    double c2 = 1.0;
    const double before = nodes[first + i - 1] - z;
    const double here = nodes[first + i] - z;
    for (std::size_t j = 0; j < i; ++j) {
      const double c3 = nodes[first + i] - nodes[first + j];
      c2 *= c3;
      if (j == i - 1) {
        slope[i] = c1 * (value[i - 1] - before * slope[i - 1]) / c2;
        value[i] = -c1 * before * value[i - 1] / c2;
      }
      slope[j] = (here * slope[j] - value[j]) / c3;
      value[j] = here * value[j] / c3;
    }
    c1 = c2;
  }
  return slope;
}

/// Value at z of the cubic through four nodes from `first` on (Lagrange).
template <typename At>
Vector2d cubicThrough(const std::vector<double>& nodes, std::size_t first, double z, const At& at) {
  Vector2d sum = Vector2d::Zero();
  for (std::size_t i = first; i < first + 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < first + 4; ++j) {
      if (j != i) weight *= (z - nodes[j]) / (nodes[i] - nodes[j]);
    }
    sum += weight * at(i);
  }
  return sum;
}

std::size_t cellOf(const std::vector<double>& nodes, double z) {
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, z);
  return static_cast<std::size_t>(above - nodes.begin()) - 1;
}

/// Hermite's four cubics on [0, 1] and their derivatives: value at 0 and 1, slope at 0 and 1.
struct Hermite {
  std::array<double, 4> value, slope;
  explicit Hermite(double u)
      : value{1 + u * u * (2 * u - 3), u * u * (3 - 2 * u), u * (1 - u) * (1 - u), u * u * (u - 1)},
        slope{6 * u * (u - 1), 6 * u * (1 - u), 1 + u * (3 * u - 4), u * (3 * u - 2)} {}
};

/// Rows of a table's file, and whether its values are steps.
struct RowsRead {
  std::vector<Row> rows;
  bool in_steps{false};
  int lines{0};
};

/// Reads the header. @returns whether the values are steps. Anything but a header ends the reading.
bool readHeader(std::string_view line, int number, Faults& faults) {
  std::string words;
  for (const char c : line) words += c == ' ' || c == '\t' ? "" : std::string(1, c);
  if (words == "x_mm,y_mm,dx_steps,dy_steps") return true;
  if (words != "x_mm,y_mm,dx_mm,dy_mm") {
    faults.add(number, "the header must be x_mm,y_mm,dx_mm,dy_mm or x_mm,y_mm,dx_steps,dy_steps");
    faults.throwIfAny();
  }
  return false;
}

RowsRead readRows(const std::string& text, Faults& faults, std::size_t most) {
  RowsRead read;
  bool header = false;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    const std::string_view line = base::trimmed(std::string_view(text).substr(from, to - from));
    from = to + 1;
    ++read.lines;
    if (line.empty() || line.front() == '#') continue;
    if (!header) {
      header = true;
      read.in_steps = readHeader(line, read.lines, faults);
      continue;
    }
    Row row;
    if (readRow(line, read.lines, faults, row)) read.rows.push_back(row);
    if (read.rows.size() > most) faults.add(read.lines, "more nodes than 1025 x 1025");
    if (read.rows.size() > most) break;
  }
  if (!header) faults.add(1, "there is no header x_mm,y_mm,dx_mm,dy_mm");
  faults.throwIfAny();
  return read;
}

/// Coordinates x of the nodes, from the first row of the grid.
std::vector<double> columnsOf(const std::vector<Row>& rows, Faults& faults) {
  std::vector<double> x;
  for (const Row& row : rows) {
    if (row.value[1] != rows.front().value[1]) break;
    if (!x.empty() && row.value[0] <= x.back())
      faults.add(row.line, fmt::format("x must ascend along a row: {:g} after {:g}", row.value[0], x.back()));
    x.push_back(row.value[0]);
  }
  faults.throwIfAny();
  return x;
}

}  // namespace

CorrectionTable CorrectionTable::parse(const std::string& text, const std::string& name) {
  Faults faults(name);
  CorrectionTable table;
  table.name_ = name;
  const RowsRead read = readRows(text, faults, kMostNodes * kMostNodes);
  const std::vector<Row>& rows = read.rows;
  if (read.in_steps) table.unit_ = Unit::kSteps;
  table.x_ = columnsOf(rows, faults);
  const std::size_t width = table.x_.size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double x = table.x_[i % width];
    if (i % width == 0) {
      if (!table.y_.empty() && row.value[1] <= table.y_.back())
        faults.add(row.line, fmt::format("y must ascend from row to row: {:g} after {:g}", row.value[1],
                                         table.y_.back()));
      table.y_.push_back(row.value[1]);
    }
    if (row.value[0] != x || row.value[1] != table.y_.back()) {
      faults.add(
          row.line,
          fmt::format(
              "the grid wants the node ({:g}, {:g}) here, not ({:g}, {:g}): rows are complete, x ascends", x,
              table.y_.back(), row.value[0], row.value[1]));
      break;  // all later nodes would be out of step
    }
    table.nodes_.push_back(
        {Vector2d(row.value[2], row.value[3]), Vector2d::Zero(), Vector2d::Zero(), Vector2d::Zero()});
  }
  if (!faults.any() && width > 0 && rows.size() % width != 0) {
    faults.add(rows.back().line, fmt::format("the last row has {} of {} nodes", rows.size() % width, width));
  }
  if (!faults.any() && (width < kLeastNodes || table.y_.size() < kLeastNodes || width > kMostNodes ||
                        table.y_.size() > kMostNodes)) {
    faults.add(read.lines, fmt::format("a grid has 3 x 3 to 1025 x 1025 nodes, this one {} x {}", width,
                                       table.y_.size()));
  }
  faults.throwIfAny();
  table.setSlopes();
  return table;
}

CorrectionTable CorrectionTable::read(const std::string& path) {
  const base::InputContent content = base::readInput(path, kMostBytes);
  if (!content.bytes) throw PlanError(path + ": " + content.refusal);
  return parse(*content.bytes, path);
}

/// Sets slopes by the polynomial through five nodes, or all if there are fewer: the error of the surface is
/// then of fourth order.
void CorrectionTable::setSlopes() {
  constexpr std::size_t kStencil = 5;
  const auto slopes = [&](const std::vector<double>& nodes, std::size_t i, const auto& at) {
    const std::size_t count = std::min(kStencil, nodes.size());
    const std::size_t first = std::min(i > count / 2 ? i - count / 2 : 0, nodes.size() - count);
    const std::vector<double> weights = slopeWeights(nodes, first, count, nodes[i]);
    Vector2d sum = Vector2d::Zero();
    for (std::size_t k = 0; k < count; ++k) sum += weights[k] * at(first + k);
    return sum;
  };
  const auto at = [&](std::size_t column, std::size_t row) -> Node& {
    return nodes_[row * x_.size() + column];
  };
  for (std::size_t row = 0; row < y_.size(); ++row) {
    for (std::size_t column = 0; column < x_.size(); ++column) {
      at(column, row)[1] = slopes(x_, column, [&](std::size_t k) { return at(k, row)[0]; });
      at(column, row)[2] = slopes(y_, row, [&](std::size_t k) { return at(column, k)[0]; });
    }
  }
  for (std::size_t row = 0; row < y_.size(); ++row) {
    for (std::size_t column = 0; column < x_.size(); ++column) {
      at(column, row)[3] = slopes(y_, row, [&](std::size_t k) { return at(column, k)[1]; });
    }
  }
}

Eigen::AlignedBox2d CorrectionTable::area_mm() const {
  return {Vector2d(x_.front(), y_.front()), Vector2d(x_.back(), y_.back())};
}

CorrectionTable::Value CorrectionTable::at(const Vector2d& p_W_mm) const {
  const double x = std::clamp(p_W_mm.x(), x_.front(), x_.back());
  const double y = std::clamp(p_W_mm.y(), y_.front(), y_.back());
  const std::size_t column = cellOf(x_, x);
  const std::size_t row = cellOf(y_, y);
  const double hx = x_[column + 1] - x_[column];
  const double hy = y_[row + 1] - y_[row];
  const Hermite u((x - x_[column]) / hx);
  const Hermite v((y - y_[row]) / hy);
  Value out;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const Node& n = node(column + i, row + j);
      const auto blend = [&](const std::array<double, 4>& a, const std::array<double, 4>& b) {
        return Vector2d(a[i] * b[j] * n[0] + a[2 + i] * b[j] * hx * n[1] + a[i] * b[2 + j] * hy * n[2] +
                        a[2 + i] * b[2 + j] * hx * hy * n[3]);
      };
      out.d += blend(u.value, v.value);
      out.gradient.col(0) += blend(u.slope, v.value) / hx;
      out.gradient.col(1) += blend(u.value, v.slope) / hy;
    }
  }
  return out;
}

CorrectionTable::Coarseness CorrectionTable::coarseness() const {
  Coarseness worst;
  const auto look = [&](const std::vector<double>& nodes, const auto& value, const auto& place) {
    if (nodes.size() < 5) return;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
      const double z = 0.5 * (nodes[i] + nodes[i + 1]);
      const std::size_t first = std::min(i > 1 ? i - 1 : 0, nodes.size() - 5);
      const double error =
          (cubicThrough(nodes, first, z, value) - cubicThrough(nodes, first + 1, z, value)).norm();
      if (error > worst.error) worst = {error, place(z)};
    }
  };
  for (std::size_t row = 0; row < y_.size(); ++row) {
    look(
        x_, [&](std::size_t k) { return node(k, row)[0]; }, [&](double z) { return Vector2d(z, y_[row]); });
  }
  for (std::size_t column = 0; column < x_.size(); ++column) {
    look(
        y_, [&](std::size_t k) { return node(column, k)[0]; },
        [&](double z) { return Vector2d(x_[column], z); });
  }
  return worst;
}

}  // namespace kerfbench::planner
