// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/compensation/contour.h"
#include "firmware_under_test/planner/compensation/space_curve.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector3d;

constexpr double kVertical = 1e-9;
constexpr double kFarthestMm = 1e6;
constexpr double kLeastChordErrorMm = 1e-4;
constexpr double kOnePlaceMm = 1e-6;
/// Distance of an arc's end from the point that follows: files give three decimals.
constexpr double kArcEndMm = 0.001;
/// Deviation of an axis at an arc's begin, as for lines (SpaceLimits::askew_deg).
constexpr double kAskewDeg = 0.5;

std::vector<std::string> wordsOf(std::string line) {
  line.resize(std::min(line.find_first_of("#;"), line.size()));
  for (char& c : line) c = c == ',' || c == '\t' || c == '\r' ? ' ' : c;
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::optional<double> numberOf(const std::string& word) {
  double value{};
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

enum class RowKind { kPoint, kVia, kCentre, kBezier, kSpline };

struct Row {
  RowKind kind{};
  std::vector<double> values;
  int line{};
  [[nodiscard]] Vector3d vector(std::size_t first) const {
    return {values[first], values[first + 1], values[first + 2]};
  }
  [[nodiscard]] SpacePoint point() const { return {vector(0), vector(3)}; }
  [[nodiscard]] bool isPlace() const { return kind == RowKind::kPoint || kind == RowKind::kSpline; }
};

struct RowForm {
  RowKind kind;
  std::string_view word;
  std::vector<std::size_t> counts;  ///< Numbers of values.
  std::string_view says;
};

const std::vector<RowForm>& rowForms() {
  static const std::vector<RowForm> forms{
      {RowKind::kPoint, "", {6}, "the six x y z i j k"},
      {RowKind::kVia, "via", {3}, "the three x y z of a place on the arc"},
      {RowKind::kCentre, "centre", {4}, "the centre x y z and the sweep in degrees"},
      {RowKind::kBezier, "bezier", {6, 9}, "two inner points x y z and, if it turns, the axis at the end"},
      {RowKind::kSpline, "spline", {6}, "the six x y z i j k"}};
  return forms;
}

/// True for what a line of a contour can begin with.
bool beginsAsRow(const std::string& word) {
  const auto& forms = rowForms();
  return numberOf(word) ||
         std::any_of(forms.begin(), forms.end(), [&](const RowForm& form) { return form.word == word; });
}

/// Parses a line's words; returns what is wrong with them.
std::string parseRow(std::vector<std::string> words, Row& row) {
  const RowForm* form = &rowForms().front();
  for (const RowForm& known : rowForms()) {
    if (words.front() == known.word) form = &known;
  }
  if (form->kind != RowKind::kPoint) words.erase(words.begin());
  row.kind = form->kind;
  for (const std::string& word : words) {
    const std::optional<double> value = numberOf(word);
    if (!value) return fmt::format("'{}' is no number", word.substr(0, 40));
    if (std::abs(*value) > kFarthestMm) return fmt::format("{} is beyond {:g}", word, kFarthestMm);
    row.values.push_back(*value);
  }
  if (std::find(form->counts.begin(), form->counts.end(), words.size()) == form->counts.end()) {
    return fmt::format("{} values instead of {}", words.size(), form->says);
  }
  return {};
}

/// Puts rows together to a contour; every fault is a CompensationError without the name of the file.
class ContourBuilder {
 public:
  explicit ContourBuilder(double chord_error_mm) : chord_error_mm_(chord_error_mm) {}

  void point(const Row& row) {
    if (after_spline_ && same(row.vector(0), contour_.points.back().p_mm)) {
      contour_.points.back() = row.point();
      contour_.file_lines.back() = row.line;
    } else {
      push(row.point(), row.line);
    }
    after_spline_ = false;
  }

  void between(const Row& row, const SpacePoint& begin, const Vector3d& end) {
    if (row.kind == RowKind::kBezier) {
      const Vector3d axis = begin.axis.normalized();
      const bool turns = row.values.size() == 9;
      beginCurve(row.line);
      add(chordsOf(SpaceCubic{{begin.p_mm, row.vector(0), row.vector(3), end},
                              axis,
                              turns ? row.vector(6).normalized() : axis},
                   chord_error_mm_),
          row.line);
      return;
    }
    const SpaceArc arc = row.kind == RowKind::kVia ? viaArc(row, begin, end) : centreArc(row, begin, end);
    beginCurve(row.line);
    add(chordsOf(arc, chord_error_mm_), row.line);
  }

  void spline(const std::vector<SpacePoint>& points, int line) {
    if (points.size() < 3) throw CompensationError("a spline needs three points in a row");
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (same(points[i - 1].p_mm, points[i].p_mm)) {
        throw CompensationError(fmt::format("points {} and {} of the spline are at one place", i, i + 1));
      }
    }
    const bool touches = !contour_.points.empty() && same(contour_.points.back().p_mm, points.front().p_mm);
    if (!touches) push(points.front(), line);
    beginCurve(line);
    for (const SpaceCubic& cubic : splineThrough(points)) {
      add(chordsOf(cubic, chord_error_mm_), line);
      push(SpacePoint{cubic.p_mm[3], cubic.axis_end}, line);
    }
    after_spline_ = true;
  }

  SpaceContour take() { return std::move(contour_); }

 private:
  static bool same(const Vector3d& a, const Vector3d& b) { return (a - b).norm() < kOnePlaceMm; }

  void push(const SpacePoint& point, int line) {
    contour_.points.push_back(point);
    contour_.file_lines.push_back(line);
  }

  void beginCurve(int line) { contour_.curves.push_back({line, contour_.points.size() - 1, 0, 0.0}); }

  /// Chords from the last point on, which gets the axis of the first.
  void add(const Chords& chords, int line) {
    contour_.points.back() = chords.begins.front();
    for (std::size_t i = 1; i < chords.begins.size(); ++i) push(chords.begins[i], line);
    SpaceCurve& curve = contour_.curves.back();
    curve.chords += chords.begins.size();
    curve.error_mm = std::max(curve.error_mm, chords.error_mm);
  }

  static SpaceArc viaArc(const Row& row, const SpacePoint& begin, const Vector3d& end) {
    const std::optional<SpaceArc> arc = arcThrough(begin, row.vector(0), end);
    if (!arc) throw CompensationError("the arc's three points lie on a straight line");
    const double off = std::acos(std::clamp(begin.axis.normalized().dot(arc->begin.axis), -1.0, 1.0)) / kDeg;
    if (off > kAskewDeg) {
      throw CompensationError(fmt::format(
          "the axis at the arc's begin stands {:.2f}° off the normal of the plane of its three points", off));
    }
    return *arc;
  }

  static SpaceArc centreArc(const Row& row, const SpacePoint& begin, const Vector3d& end) {
    // An axis that is askew by less than the limit is turned to the right angle to the radius.
    const Vector3d radius = begin.p_mm - row.vector(0);
    if (radius.norm() < kOnePlaceMm) throw CompensationError("the arc begins at its centre");
    const Vector3d u = radius.normalized();
    const Vector3d axis = begin.axis.normalized();
    const double off = std::asin(std::clamp(axis.dot(u), -1.0, 1.0)) / kDeg;
    if (std::abs(off) > kAskewDeg) {
      throw CompensationError(
          fmt::format("the axis stands {:.2f}° off the right angle to the arc's radius", std::abs(off)));
    }
    const double sweep = row.values[3] * kDeg;
    if (!(std::abs(sweep) > 0.0) || std::abs(sweep) > 2.0 * kPi + 1e-9) {
      throw CompensationError(fmt::format(
          "a sweep of {:g}°, but 360° either way are the most and none is no arc", row.values[3]));
    }
    const SpaceArc arc{{begin.p_mm, (axis - axis.dot(u) * u).normalized()}, row.vector(0), sweep};
    const double miss = (arc.at(1.0) - end).norm();
    if (miss > kArcEndMm) {
      throw CompensationError(fmt::format("the arc ends {:.4f} mm beside the point that follows", miss));
    }
    return arc;
  }

  double chord_error_mm_;
  SpaceContour contour_;
  bool after_spline_{};
};

/// Adds rows from `i` on that make one part of the contour; returns the index behind them.
std::size_t addPart(ContourBuilder& builder, const std::vector<Row>& rows, std::size_t i) {
  const Row& row = rows[i];
  if (row.kind == RowKind::kPoint) {
    builder.point(row);
    return i + 1;
  }
  if (row.kind == RowKind::kSpline) {
    std::vector<SpacePoint> points;
    std::size_t end = i;
    for (; end < rows.size() && rows[end].kind == RowKind::kSpline; ++end)
      points.push_back(rows[end].point());
    builder.spline(points, row.line);
    return end;
  }
  if (i == 0 || i + 1 == rows.size() || !rows[i - 1].isPlace() || !rows[i + 1].isPlace()) {
    throw CompensationError("an arc or a curve needs a point before and a point behind it");
  }
  builder.between(row, rows[i - 1].point(), rows[i + 1].vector(0));
  return i + 1;
}

double rounded(double value) { return std::round(value * 1e4) / 1e4 + 0.0; }

}  // namespace

SpaceContour readSpaceContour(const std::string& text, const std::string& name, double chord_error_mm) {
  if (!(chord_error_mm >= kLeastChordErrorMm && chord_error_mm <= 1.0)) {
    throw CompensationError(fmt::format("a chord error of {:g} mm, but {:g} … 1 mm are taken", chord_error_mm,
                                        kLeastChordErrorMm));
  }
  std::vector<std::string> faults;
  const auto fault = [&](int line, const std::string& what) {
    if (faults.size() < kMostFaults) faults.push_back(fmt::format("{}: line {}: {}", name, line, what));
  };
  std::vector<Row> rows;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    Row row;
    row.line = ++number;
    const std::vector<std::string> words = wordsOf(line);
    if (words.empty()) continue;
    const std::string what = parseRow(words, row);
    // Words of a file that is no contour at all are nobody's business.
    if (rows.empty() && faults.empty() && !beginsAsRow(words.front())) {
      throw CompensationError(
          fmt::format("{}: line {}: begins with neither a number nor a word of a contour: it is no contour",
                      name, number));
    }
    what.empty() ? rows.push_back(std::move(row)) : fault(number, what);
  }
  ContourBuilder builder(chord_error_mm);
  // Faults of rows come first: what they make together is known only when each is.
  for (std::size_t i = 0; faults.empty() && i < rows.size();) {
    const int line = rows[i].line;
    try {
      i = addPart(builder, rows, i);
    } catch (const CompensationError& error) {
      fault(line, error.what());
    }
  }
  SpaceContour contour = builder.take();
  if (faults.empty() && contour.points.size() < 2) faults.push_back(name + ": a contour needs two points");
  if (!faults.empty()) throw CompensationError(fmt::format("{}", fmt::join(faults, "\n")));
  return contour;
}

std::vector<Pose> posesOf(const std::vector<SpacePoint>& path) {
  std::vector<Pose> poses;
  double c = 0.0;
  for (const SpacePoint& point : path) {
    const Eigen::Vector3d& n = point.axis;
    const double across = std::hypot(n.x(), n.y());
    if (across > kVertical) {
      const double next = std::atan2(n.x(), -n.y()) / kDeg;
      c = next + 360.0 * std::round((c - next) / 360.0);
    }
    poses.push_back({point.p_mm, std::atan2(across, n.z()) / kDeg, c});
  }
  return poses;
}

std::string writePoses(const std::vector<Pose>& poses) {
  std::string text;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Pose& pose = poses[i];
    text += fmt::format("{} X{:.4f} Y{:.4f} Z{:.4f} A{:.4f} C{:.4f}\n", i == 0 ? "G00" : "G01",
                        rounded(pose.p_mm.x()), rounded(pose.p_mm.y()), rounded(pose.p_mm.z()),
                        rounded(pose.a_deg), rounded(pose.c_deg));
  }
  return text;
}

}  // namespace kerfbench::planner
