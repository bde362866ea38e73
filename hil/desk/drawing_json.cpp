// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/drawing_json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "hil/desk/json_text.h"
#include "hil/desk/scenario_check.h"
#include "hil/dieline/remarks.h"

namespace kerfbench::desk {
namespace {

using dieline::Process;
using Eigen::Vector2d;
using nlohmann::json;

/// Parts of the parameter's range that are looked at by themselves, and how often each is halved at most.
constexpr int kParts = 4;
constexpr int kDeepest = 12;
constexpr double kWholeTurn = 2.0 * std::numbers::pi;

double distanceFromChord(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  const double square = ab.squaredNorm();
  const double u = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
  return (p - a - u * ab).norm();
}

/// Adds what follows behind `a` up to `b`. Quarters as well as the middle are held against the chord: a
/// middle may lie on it by chance.
void halve(const dieline::Curve& curve, double u, double v, const Vector2d& a, const Vector2d& b, int depth,
           std::vector<Vector2d>& points) {
  const Vector2d middle = dieline::pointAt(curve, 0.5 * (u + v));
  bool is_close = depth >= kDeepest;
  if (!is_close) {
    is_close = distanceFromChord(middle, a, b) <= kDrawnWithin_mm;
    for (const double share : {0.25, 0.75})
      is_close = is_close &&
                 distanceFromChord(dieline::pointAt(curve, u + share * (v - u)), a, b) <= kDrawnWithin_mm;
  }
  if (is_close) {
    points.push_back(b);
    return;
  }
  halve(curve, u, 0.5 * (u + v), a, middle, depth + 1, points);
  halve(curve, 0.5 * (u + v), v, middle, b, depth + 1, points);
}

std::vector<Vector2d> arcPoints(const dieline::ArcCurve& arc) {
  // The sagitta of a chord over an angle h is r (1 - cos h/2).
  const double share = std::min(1.0, kDrawnWithin_mm / arc.radius_mm);
  const double widest_rad = std::min(2.0 * std::acos(1.0 - share), 0.25 * kWholeTurn);
  const double parts = std::clamp(std::ceil(std::abs(arc.sweep_rad) / widest_rad), 1.0, 1e5);
  std::vector<Vector2d> points;
  for (int i = 0; i <= static_cast<int>(parts); ++i) points.push_back(dieline::pointAt(arc, i / parts));
  return points;
}

json pairOf(const Vector2d& p_mm) { return {rounded_mm(p_mm.x()), rounded_mm(p_mm.y())}; }

/// Lines of all entities, as JSON and as paths of the picture.
class LineWriter {
 public:
  explicit LineWriter(const dieline::Dieline& drawing) {
    for (const dieline::Entity& entity : drawing.entities) {
      box_.extend(dieline::pointAt(entity.curve, 0.0));
      add(entity);
    }
  }

  json entities() { return std::move(entities_); }
  [[nodiscard]] std::size_t shown() const { return shown_; }
  [[nodiscard]] const Eigen::AlignedBox2d& box_mm() const { return box_; }

  [[nodiscard]] std::string svg() const {
    const Vector2d low = box_.isEmpty() ? Vector2d::Zero() : box_.min();
    const Vector2d size = box_.isEmpty() ? Vector2d::Zero() : Vector2d(box_.sizes());
    std::string text = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.4f} {:.4f} {:.4f} {:.4f}\" fill=\"none\" "
        "stroke=\"currentColor\">",
        low.x(), -low.y() - size.y(), size.x(), size.y());
    for (const auto& [process, paths] : paths_)
      text += fmt::format("<g class=\"{}\">{}</g>", dieline::processName(process), paths);
    return text + "</svg>";
  }

 private:
  void add(const dieline::Entity& entity) {
    std::vector<Vector2d> points;
    const bool has_room = shown_ < kMostEntitiesShown && points_ < kMostPointsShown;
    if (has_room) points = polylineOf(entity.curve);
    for (const Vector2d& p : points) box_.extend(p);
    if (!has_room) return;
    ++shown_;
    points_ += points.size();
    json list = json::array();
    std::string path;
    for (const Vector2d& p : points) {
      list.push_back(pairOf(p));
      path += fmt::format("{}{:.4f} {:.4f}", path.empty() ? 'M' : 'L', p.x(), -p.y() + 0.0);
    }
    const bool is_closed = dieline::isClosed(entity.curve);
    json value{{"id", entity.id},
               {"layer", entity.layer},
               {"process", dieline::processName(entity.process)},
               {"length_mm", rounded_mm(dieline::lengthOf(entity.curve))},
               {"line", lineOfOrigin(entity.origin)},
               {"origin", entity.origin},
               {"closed", is_closed},
               {"points_mm", std::move(list)}};
    if (entity.left_out) value["left_out"] = dieline::processName(*entity.left_out);
    entities_.push_back(std::move(value));
    paths_[entity.process] +=
        fmt::format("<path data-entity=\"{}\" d=\"{}{}\"/>", entity.id, path, is_closed ? "Z" : "");
  }

  json entities_ = json::array();
  std::map<Process, std::string> paths_;
  Eigen::AlignedBox2d box_;
  std::size_t shown_{}, points_{};
};

json layersOf(const dieline::Dieline& drawing) {
  struct Row {
    std::size_t count{};
    double length_mm{};
  };
  std::map<std::pair<std::string, Process>, Row> rows;
  for (const dieline::Entity& entity : drawing.entities) {
    Row& row = rows[{entity.layer, dieline::drawnFor(entity)}];
    ++row.count;
    row.length_mm += dieline::lengthOf(entity.curve);
  }
  json layers = json::array();
  for (const auto& [key, row] : rows) {
    layers.push_back({{"name", key.first},
                      {"process", dieline::processName(key.second)},
                      {"count", row.count},
                      {"length_mm", rounded_mm(row.length_mm)}});
  }
  return layers;
}

json findingsOf(const dieline::Dieline& drawing, const dieline::LintReport& lint,
                const std::set<dieline::LintFinding::Kind>& accepted) {
  std::map<int, int> lines;
  for (const dieline::Entity& entity : drawing.entities) lines[entity.id] = lineOfOrigin(entity.origin);
  json findings = json::array();
  for (const dieline::LintFinding& finding : lint.findings) {
    const bool is_accepted = dieline::isAccepted(finding, accepted);
    findings.push_back({{"kind", dieline::lintName(finding.kind)},
                        {"severity", finding.is_error && !is_accepted ? "error" : "warning"},
                        {"message", finding.message},
                        {"layer", finding.layer},
                        {"where_mm", pairOf(finding.p_mm)},
                        {"entities", finding.entities},
                        {"line", finding.entities.empty() ? 0 : lines[finding.entities.front()]},
                        {"accepted", is_accepted},
                        {"may_be_accepted", finding.may_be_accepted}});
  }
  return findings;
}

}  // namespace

std::vector<Vector2d> polylineOf(const dieline::Curve& curve) {
  if (const auto* line = std::get_if<dieline::LineCurve>(&curve)) return {line->start_mm, line->end_mm};
  if (const auto* arc = std::get_if<dieline::ArcCurve>(&curve)) return arcPoints(*arc);
  std::vector<Vector2d> points{dieline::pointAt(curve, 0.0)};
  for (int i = 0; i < kParts; ++i) {
    const double u = static_cast<double>(i) / kParts;
    const double v = static_cast<double>(i + 1) / kParts;
    halve(curve, u, v, points.back(), dieline::pointAt(curve, v), 0, points);
  }
  return points;
}

int lineOfOrigin(const std::string& origin) {
  constexpr std::string_view kWord = "line ";
  const std::size_t at = origin.find(kWord);
  int line = 0;
  if (at == std::string::npos) return 0;
  const char* const begin = origin.data() + at + kWord.size();
  const auto [end, error] = std::from_chars(begin, origin.data() + origin.size(), line);
  return error == std::errc() ? line : 0;
}

json drawingJson(const dieline::Dieline& drawing, const dieline::LintReport& lint,
                 const std::set<dieline::LintFinding::Kind>& accepted) {
  LineWriter lines(drawing);
  std::vector<std::string> notes = drawing.notes;
  for (std::string& sentence : dieline::uncounted(lint)) notes.push_back(std::move(sentence));
  if (auto advice = dieline::adviceOnRepeats(lint)) notes.push_back(std::move(*advice));
  for (std::string& sentence : dieline::acceptedSentences(lint, accepted))
    notes.push_back(std::move(sentence));
  if (lines.shown() < drawing.entities.size()) {
    notes.push_back(fmt::format("{} of {} lines are shown: a picture has no more than {} lines and {} points",
                                lines.shown(), drawing.entities.size(), kMostEntitiesShown,
                                kMostPointsShown));
  }
  json unit;
  if (const auto& unsaid = drawing.unsaid_unit)
    unit = {{"line", unsaid->line},
            {"taken_mm", unsaid->taken_mm},
            {"name", dieline::nameOfUnit(unsaid->taken_mm)}};
  const bool is_empty = lines.box_mm().isEmpty();
  return {{"svg", lines.svg()},
          {"size_mm", pairOf(is_empty ? Vector2d::Zero() : Vector2d(lines.box_mm().sizes()))},
          {"min_mm", pairOf(is_empty ? Vector2d::Zero() : Vector2d(lines.box_mm().min()))},
          {"shown", lines.shown()},
          {"count", drawing.entities.size()},
          {"entities", lines.entities()},
          {"findings", findingsOf(drawing, lint, accepted)},
          {"layers", layersOf(drawing)},
          {"unsaid_unit", std::move(unit)},
          {"notes", std::move(notes)}};
}

}  // namespace kerfbench::desk
