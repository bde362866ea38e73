// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/dieline/cf2_records.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// Places the SUBs of a file and gives each line its process.
class Cf2Drawing {
 public:
  Cf2Drawing(const Cf2File& file, const LayerProfile& profile, FaultList& faults)
      : file_(file), profile_(profile), faults_(faults) {}

  Dieline read() {
    dieline_.path = faults_.path();
    const std::size_t count = countOf(file_.main, "MAIN", 0).count;
    faults_.throwIfAny();
    dieline_.entities.reserve(count);
    place(file_.main, Eigen::Affine2d(Eigen::Scaling(file_.unit_mm)));
    faults_.throwIfAny();
    note();
    return std::move(dieline_);
  }

 private:
  /// What a block holds with all that it places.
  struct Unfolded {
    std::size_t count{};  ///< Entities.
    int height{};         ///< Levels of C.
  };

  /// Each SUB is counted once, so that no file takes long; its levels count wherever it is placed.
  Unfolded countOf(const Cf2Block& block, const std::string& name, int depth) {
    Unfolded sum{block.curves.size() + block.copies.size(), 0};
    for (const Cf2Copy& copy : block.copies) {
      const auto sub = file_.subs.find(copy.name);
      if (sub == file_.subs.end()) {
        faults_.add(copy.line, fmt::format("C of {}, which is not in the file", inQuotes(copy.name)));
        continue;
      }
      placed_.insert(copy.name);
      const auto known = known_.find(copy.name);
      if (depth + (known == known_.end() ? 0 : known->second.height) >= kDeepestNesting) {
        faults_.fatal(copy.line, fmt::format("{} is nested deeper than {}: does it hold itself?",
                                             inQuotes(copy.name), kDeepestNesting));
      }
      const Unfolded inner =
          known == known_.end() ? countOf(sub->second, copy.name, depth + 1) : known->second;
      sum.count += inner.count;
      sum.height = std::max(sum.height, 1 + inner.height);
      if (sum.count > kMostEntities)
        faults_.fatal(copy.line, fmt::format("more than {} entities", kMostEntities));
    }
    return known_[name] = sum;
  }

  void place(const Cf2Block& block, const Eigen::Affine2d& X) {
    for (const Cf2Curve& curve : block.curves) add(curve, X);
    for (const Cf2Copy& copy : block.copies) {
      Eigen::Affine2d inner = X;
      inner.translate(copy.shift)
          .rotate(Eigen::Rotation2Dd(copy.angle_deg * std::numbers::pi / 180.0))
          .scale(copy.scale);
      place(file_.subs.find(copy.name)->second, inner);
    }
  }

  void add(const Cf2Curve& curve, const Eigen::Affine2d& X) {
    std::string layer = fmt::format("CF2 type {}", curve.type);
    const auto known = processes_.try_emplace(curve.type);
    if (known.second) known.first->second = processFor(profile_, layer);
    const std::optional<Process> process = known.first->second;
    if (!process) {
      // One fault for all lines of a type.
      if (known.second) {
        faults_.add(curve.line,
                    fmt::format("lines like this one are of type {}, and the profile {} has no rule for {}",
                                curve.type, inQuotes(profile_.name), inQuotes(layer)));
      }
      return;
    }
    if (curve.bridges > 0) {
      ++bridged_;
      bridges_ += static_cast<std::size_t>(curve.bridges);
    }
    dieline_.entities.push_back(
        {static_cast<int>(dieline_.entities.size()),
         transformed(curve.curve, X),
         *process,
         std::move(layer),
         fmt::format("line {}: {} of {:g} pt", curve.line,
                     std::holds_alternative<LineCurve>(curve.curve) ? "L" : "A", curve.rule_pt),
         {}});
  }

  void note() {
    if (file_.texts > 0) dieline_.notes.push_back(fmt::format("Ignored: {} texts.", file_.texts));
    if (bridges_ > 0) {
      dieline_.notes.push_back(fmt::format(
          "Ignored: {} bridges of {} lines. They hold the board of a die together, and the cut goes through.",
          bridges_, bridged_));
    }
    std::vector<std::string> unplaced;
    for (const auto& [name, sub] : file_.subs) {
      if (!sub.curves.empty() && !placed_.contains(name)) unplaced.push_back(inQuotes(name));
    }
    if (!unplaced.empty())
      dieline_.notes.push_back(
          fmt::format("Ignored: SUB {}, which nothing places.", fmt::join(unplaced, ", ")));
    if (!file_.has_end) dieline_.notes.push_back("The file has no $EOF; each of its blocks is whole.");
  }

  const Cf2File& file_;
  const LayerProfile& profile_;
  FaultList& faults_;
  Dieline dieline_;
  std::map<std::string, Unfolded> known_;
  std::set<std::string> placed_;
  std::map<int, std::optional<Process>> processes_;  // Rules are looked up once for each type.
  std::size_t bridges_{};
  std::size_t bridged_{};
};

}  // namespace

Dieline readCf2(const std::string& text, const DrawingOptions& options, FaultList& faults) {
  if (options.unit)
    faults.fatal(0, "a CF2 file says its unit itself (UM, UI): leave 'unit' out, or use 'scale'");
  base::ShareProgress progress = readingProgress(options, faults, text.size());
  const Cf2File file = readCf2Records(text, faults, progress);
  faults.throwIfAny();
  return Cf2Drawing(file, options.layers, faults).read();
}

}  // namespace kerfbench::dieline
