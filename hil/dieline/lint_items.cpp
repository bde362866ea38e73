// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/lint_items.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/dieline/curve_math.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Kind = LintFinding::Kind;

std::string label(const LintItem& item) {
  return fmt::format("E{} ({}, {})", item.entity->id, item.entity->origin, processName(item.entity->process));
}

/// True where `a` is worse than `b`.
bool isWorse(const LintRaw& a, const LintRaw& b) {
  const bool a_must = a.is_error && !a.may_be_accepted;
  const bool b_must = b.is_error && !b.may_be_accepted;
  if (a_must != b_must) return a_must;
  if (a.size_mm != b.size_mm) return a.size_mm > b.size_mm;
  return a.number < b.number;
}

/// Length on which two lines lie on each other.
double shared(const LineCurve& a, const LineCurve& b) {
  const double length = (a.end_mm - a.start_mm).norm();
  const Vector2d along = (a.end_mm - a.start_mm) / length;
  const Vector2d across(-along.y(), along.x());
  double s0 = along.dot(b.start_mm - a.start_mm);
  double s1 = along.dot(b.end_mm - a.start_mm);
  double d0 = across.dot(b.start_mm - a.start_mm);
  double d1 = across.dot(b.end_mm - a.start_mm);
  if (s0 > s1) {
    std::swap(s0, s1);
    std::swap(d0, d1);
  }
  const double lo = std::max(s0, 0.0);
  const double hi = std::min(s1, length);
  if (!(hi - lo > 0)) return 0.0;
  const auto offset = [&](double s) { return std::abs(d0 + (d1 - d0) * (s - s0) / (s1 - s0)); };
  return std::max(offset(lo), offset(hi)) < kSame_mm ? hi - lo : 0.0;
}

double shared(const ArcCurve& a, const ArcCurve& b) {
  if ((a.centre_mm - b.centre_mm).norm() + std::abs(a.radius_mm - b.radius_mm) > kSame_mm) return 0.0;
  const double turn = 2 * std::numbers::pi;
  const auto first = [](const ArcCurve& c) {
    return c.sweep_rad > 0 ? c.start_angle_rad : c.start_angle_rad + c.sweep_rad;
  };
  double from = std::fmod(first(b) - first(a), turn);
  if (from < 0) from += turn;
  double shared = 0;
  for (const double begin : {from - turn, from}) {
    shared +=
        std::max(0.0, std::min(begin + std::abs(b.sweep_rad), std::abs(a.sweep_rad)) - std::max(begin, 0.0));
  }
  return shared * a.radius_mm;
}

/// Places of entities in an order in which neighbours follow each other mostly: that of the bits of x and y
/// of their starts in turn.
std::vector<std::uint32_t> alongTheSheet(const std::vector<const Entity*>& entities) {
  Eigen::AlignedBox2d box;
  std::vector<Vector2d> starts_mm;
  starts_mm.reserve(entities.size());
  for (const Entity* entity : entities) {
    starts_mm.push_back(pointAt(entity->curve, 0.0));
    box.extend(starts_mm.back());
  }
  const auto spread = [](double share) {
    auto bits = static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * 65535.0);
    bits = (bits | (bits << 8U)) & 0x00ff00ffU;
    bits = (bits | (bits << 4U)) & 0x0f0f0f0fU;
    bits = (bits | (bits << 2U)) & 0x33333333U;
    return (bits | (bits << 1U)) & 0x55555555U;
  };
  const Vector2d size_mm = box.sizes().cwiseMax(1e-9);
  std::vector<std::uint64_t> keys(entities.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Vector2d share = (starts_mm[i] - box.min()).cwiseQuotient(size_mm);
    keys[i] = (spread(share.x()) | (spread(share.y()) << 1U)) << 32U | i;
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const std::uint64_t key : keys) order.push_back(static_cast<std::uint32_t>(key));
  return order;
}

LintItem lintItem(const Entity& entity, std::uint32_t number) {
  LintItem item{&entity, boundsOf(entity.curve), lengthOf(entity.curve), {}, false, isClosed(entity.curve),
                number};
  item.is_zero = item.length_mm < kZero_mm;
  const bool is_line = std::holds_alternative<LineCurve>(entity.curve);
  const std::vector<double> u =
      item.is_zero || is_line ? std::vector<double>() : stations(entity.curve, item.length_mm / 4);
  for (std::size_t i = 0; i < 5; ++i) {
    const double at = item.is_zero ? 0.0 : is_line ? static_cast<double>(i) / 4 : u[i];
    item.samples.at(i) = pointAt(entity.curve, at);
  }
  return item;
}

}  // namespace

std::vector<LintItem> lintItems(const Dieline& dieline) {
  std::vector<LintItem> items;
  items.reserve(dieline.entities.size());
  std::vector<const Entity*> entities;
  for (const Entity& entity : dieline.entities) {
    if (entity.process != Process::kIgnore) entities.push_back(&entity);
  }
  for (const std::uint32_t at : alongTheSheet(entities)) items.push_back(lintItem(*entities[at], at));
  return items;
}

double lintSharedLength(const LintItem& a, const LintItem& b) {
  const auto* line_a = std::get_if<LineCurve>(&a.entity->curve);
  const auto* line_b = std::get_if<LineCurve>(&b.entity->curve);
  const auto* arc_a = std::get_if<ArcCurve>(&a.entity->curve);
  const auto* arc_b = std::get_if<ArcCurve>(&b.entity->curve);
  if (line_a != nullptr && line_b != nullptr) {
    // On the longer one: its direction is the better known.
    return a.length_mm >= b.length_mm ? shared(*line_a, *line_b) : shared(*line_b, *line_a);
  }
  return arc_a != nullptr && arc_b != nullptr ? shared(*arc_a, *arc_b) : 0.0;
}

bool lintSame(const LintItem& a, const LintItem& b) {
  if (std::abs(a.length_mm - b.length_mm) > 2 * kSame_mm) return false;
  if ((a.box.min() - b.box.min()).norm() > 2 * kSame_mm || (a.box.max() - b.box.max()).norm() > 2 * kSame_mm)
    return false;
  double same = 0;
  double opposite = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    same = std::max(same, (a.samples.at(i) - b.samples.at(i)).norm());
    opposite = std::max(opposite, (a.samples.at(i) - b.samples.at(4 - i)).norm());
  }
  if (std::min(same, opposite) <= kSame_mm) return true;
  // Closed curves may start anywhere.
  if (!a.is_closed || !b.is_closed) return false;
  return std::all_of(a.samples.begin(), a.samples.end(), [&](const Vector2d& p) {
    return nearestOn(b.entity->curve, p).distance_mm <= kSame_mm;
  });
}

void LintStore::add(LintRaw raw) {
  raw.number = number_++;
  LintReport::Counts& counts = counts_[raw.kind];
  ++counts.all;
  if (raw.is_error && !raw.may_be_accepted) ++counts.not_to_be_accepted;
  std::vector<LintRaw>& heap = kept_[raw.kind];
  heap.push_back(raw);
  if (most_ == kAllFindings) return;
  std::push_heap(heap.begin(), heap.end(), isWorse);
  if (heap.size() <= most_) return;
  std::pop_heap(heap.begin(), heap.end(), isWorse);
  heap.pop_back();
}

void LintStore::add(LintFinding finding) {
  LintReport::Counts& counts = counts_[finding.kind];
  ++counts.all;
  if (finding.is_error) ++counts.not_to_be_accepted;
  in_words_.push_back(std::move(finding));
}

LintFinding LintStore::inWords(const LintRaw& raw) const {
  const LintItem& a = items_[raw.item];
  std::string message;
  switch (raw.kind) {
    case Kind::kZeroLength:
      message = fmt::format("{} is only {:.6f} mm long.", label(a), raw.size_mm);
      break;
    case Kind::kDuplicate:
      message = fmt::format("{} repeats {}, {:.3f} mm.", label(a), label(items_[raw.other]), raw.size_mm);
      break;
    case Kind::kOverlap:
      message = fmt::format("{} lies on {} for {:.3f} mm.", label(a), label(items_[raw.other]), raw.size_mm);
      break;
    case Kind::kGap:
      message = fmt::format("{} ends {:.4f} mm short of an end of {}.", label(a), raw.size_mm,
                            label(items_[raw.other]));
      break;
    default:
      message = fmt::format("The cut outline with {} is open: {} loose end(s), one at ({:.3f}, {:.3f}) mm.",
                            label(a), raw.other, raw.p_mm.x(), raw.p_mm.y());
  }
  std::vector<int> entities{a.entity->id};
  if (raw.kind == Kind::kDuplicate || raw.kind == Kind::kOverlap || raw.kind == Kind::kGap)
    entities.push_back(items_[raw.other].entity->id);
  return {raw.kind,           raw.is_error,        raw.p_mm,    a.entity->layer,
          std::move(message), raw.may_be_accepted, raw.size_mm, std::move(entities)};
}

LintReport LintStore::report() && {
  LintReport report;
  report.counts = std::move(counts_);
  for (auto& [kind, raws] : kept_) {
    std::sort(raws.begin(), raws.end(), isWorse);
    for (const LintRaw& raw : raws) report.findings.push_back(inWords(raw));
  }
  for (LintFinding& finding : in_words_) report.findings.push_back(std::move(finding));
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const LintFinding& a, const LintFinding& b) { return a.kind < b.kind; });
  return report;
}

}  // namespace kerfbench::dieline
