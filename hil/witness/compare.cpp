// SPDX-License-Identifier: Apache-2.0
#include "hil/witness/compare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/dieline/curve_math.h"
#include "hil/dieline/faults.h"
#include "hil/dieline/layer_styles.h"

namespace kerfbench::witness {
namespace {

using dieline::FileFormat;
using dieline::Process;

/// What is known of the lines of one layer for one process.
struct LayerSum {
  std::string layer;  ///< As it is written.
  std::size_t lines{};
  double length_mm{};
  double lost_mm{};  ///< What the sum lost by rounding (Kahan).
  Eigen::AlignedBox2d box_mm;

  void add(std::size_t count, double more_mm, const Eigen::AlignedBox2d& box) {
    lines += count;
    const double mended = more_mm - lost_mm;
    const double sum = length_mm + mended;
    lost_mm = (sum - length_mm) - mended;
    length_mm = sum;
    box_mm.extend(box);
  }
};

/// Layer in lower case and process.
using Key = std::pair<std::string, Process>;
using Sums = std::map<Key, LayerSum>;

/// Layers alone are compared in a PDF: all its keys have the same process.
constexpr Process kAnyProcess = Process::kCut;

Sums ourSums(const dieline::Dieline& dieline, bool is_pdf) {
  Sums sums;
  for (const dieline::Entity& entity : dieline.entities) {
    const Process process = is_pdf ? kAnyProcess : dieline::drawnFor(entity);
    if (process == Process::kIgnore) continue;
    LayerSum& sum = sums[{base::lowered(entity.layer), process}];
    if (sum.layer.empty()) sum.layer = entity.layer;
    sum.add(1, dieline::lengthOf(entity.curve), dieline::boundsOf(entity.curve));
  }
  return sums;
}

/// Layer and process that our rules give to lines that the second reader found.
class Mapping {
 public:
  Mapping(const dieline::DrawingOptions& options, FileFormat format)
      : profile_(options.layers),
        is_pdf_(format == FileFormat::kPdf),
        is_svg_(format == FileFormat::kSvg),
        census_(options.layers),
        faults_("the second reader") {}

  /// Nothing for lines that are not cut.
  std::optional<std::pair<std::string, Process>> of(const WitnessedLines& lines, std::string_view what) {
    if (is_pdf_) return std::pair(pdfLayer(lines), kAnyProcess);
    const std::string layer = layerOf(lines);
    if (is_svg_ && lines.colours.front() == "none" && !hasRule(profile_, "none")) return std::nullopt;
    if (!lines.is_plotted && !hasRule(profile_, layer)) return std::nullopt;
    const dieline::LineStyle style{
        dieline::normalColour(lines.colours.front()).value_or(lines.colours.front()),
        dieline::normalLinetype(lines.linetype)};
    const auto process = census_.processOf(layer, style, 0, what, faults_);
    if (!process || *process == Process::kIgnore) return std::nullopt;
    return std::pair(layer, *process);
  }

  /// Lines on layers, or drawn in ways, for which there is no rule: ours did not find them.
  [[nodiscard]] std::string faults() {
    census_.refuse(faults_);
    try {
      faults_.throwIfAny();
    } catch (const dieline::DielineError& error) {
      return error.what();
    }
    return {};
  }

 private:
  [[nodiscard]] std::string layerOf(const WitnessedLines& lines) const {
    if (!is_svg_) return lines.names.empty() ? "0" : lines.names.back();
    const auto named = std::find_if(lines.names.rbegin(), lines.names.rend(),
                                    [&](const std::string& name) { return hasRule(profile_, name); });
    return named == lines.names.rend() ? lines.colours.front() : *named;
  }
  /// The innermost layer that a rule names, else the colour.
  [[nodiscard]] std::string pdfLayer(const WitnessedLines& lines) const {
    std::vector<std::string> names(lines.names.rbegin(), lines.names.rend());
    names.insert(names.end(), lines.colours.begin(), lines.colours.end());
    for (const std::string& name : names) {
      if (lines.linetype == "dashed" && hasRule(profile_, name + " dashed")) return name + " dashed";
      if (hasRule(profile_, name)) return name;
    }
    return lines.colours.front();
  }

  const dieline::LayerProfile& profile_;
  bool is_pdf_;
  bool is_svg_;
  dieline::LayerCensus census_;
  dieline::FaultList faults_;
};

std::string nameOf(const Key& key, const LayerSum& sum, bool is_pdf) {
  if (is_pdf) return fmt::format("layer {}", base::inQuotes(sum.layer));
  return fmt::format("layer {} ({})", base::inQuotes(sum.layer), dieline::processName(key.second));
}

std::string boxText(const Eigen::AlignedBox2d& box) {
  return fmt::format("x {:.4f} to {:.4f}, y {:.4f} to {:.4f} mm", box.min().x(), box.max().x(), box.min().y(),
                     box.max().y());
}

/// Compares what both know by one name.
class Comparer {
 public:
  Comparer(const Tolerance& tolerance, double extent_mm, Comparison& result)
      : tolerance_(tolerance), extent_mm_(extent_mm), result_(result) {}

  void compare(const std::string& name, const LayerSum& ours, const LayerSum& theirs) {
    ++result_.layers;
    result_.length_mm += ours.length_mm;
    const double length_mm = std::abs(ours.length_mm - theirs.length_mm);
    const double limit_mm =
        tolerance_.lengthLimit_mm(ours.length_mm, std::max(ours.lines, theirs.lines), extent_mm_);
    // Written so that what is no number is no agreement.
    if (!(length_mm <= limit_mm)) {
      result_.partings.push_back(fmt::format(
          "{}: this reader finds {:.6f} mm of lines, the second one {:.6f} mm, which is {:.6f} mm apart; "
          "{:.6f} mm may be rounding",
          name, ours.length_mm, theirs.length_mm, length_mm, limit_mm));
    }
    const double box_mm = std::max((ours.box_mm.min() - theirs.box_mm.min()).cwiseAbs().maxCoeff(),
                                   (ours.box_mm.max() - theirs.box_mm.max()).cwiseAbs().maxCoeff());
    if (!(box_mm <= tolerance_.box_mm)) {
      result_.partings.push_back(fmt::format(
          "{}: for this reader its lines reach over {}, for the second one over {}, which is {:.6f} mm apart",
          name, boxText(ours.box_mm), boxText(theirs.box_mm), box_mm));
    }
    result_.worst_length_mm = std::max(result_.worst_length_mm, length_mm);
    result_.worst_box_mm = std::max(result_.worst_box_mm, box_mm);
  }

 private:
  const Tolerance& tolerance_;
  double extent_mm_;
  Comparison& result_;
};

double extentOfAll(const Sums& sums) {
  double extent_mm = 0;
  for (const auto& [key, sum] : sums)
    extent_mm =
        std::max({extent_mm, sum.box_mm.min().cwiseAbs().maxCoeff(), sum.box_mm.max().cwiseAbs().maxCoeff()});
  return extent_mm;
}

/// Layers that the other reading does not know by name.
Sums onlyIn(const Sums& sums, const Sums& other) {
  Sums only;
  for (const auto& [key, sum] : sums) {
    if (!other.contains(key)) only.emplace(key, sum);
  }
  return only;
}

LayerSum whole(const Sums& sums) {
  LayerSum all;
  for (const auto& [key, sum] : sums) all.add(sum.lines, sum.length_mm, sum.box_mm);
  return all;
}

std::string namesOf(const Sums& sums) {
  std::string names;
  for (const auto& [key, sum] : sums) names += (names.empty() ? "" : ", ") + base::inQuotes(sum.layer);
  return names;
}

void compareSums(const Sums& ours, const Sums& theirs, FileFormat format, Comparison& result) {
  const bool is_pdf = format == FileFormat::kPdf;
  const Tolerance tolerance = toleranceFor(format);
  Comparer comparer(tolerance, std::max(extentOfAll(ours), extentOfAll(theirs)), result);
  for (const auto& [key, sum] : ours) {
    const auto found = theirs.find(key);
    if (found != theirs.end()) comparer.compare(nameOf(key, sum, is_pdf), sum, found->second);
  }
  const Sums our_own = onlyIn(ours, theirs);
  const Sums their_own = onlyIn(theirs, ours);
  if (is_pdf && !our_own.empty() && !their_own.empty()) {
    comparer.compare(
        fmt::format("layers {}, which the second reader knows as {}", namesOf(our_own), namesOf(their_own)),
        whole(our_own), whole(their_own));
    return;
  }
  const auto tell = [&](const Sums& only, std::string_view finder, std::string_view other) {
    for (const auto& [key, sum] : only) {
      result.partings.push_back(fmt::format("{}: {} finds {} lines of {:.6f} mm there, {} finds none",
                                            nameOf(key, sum, is_pdf), finder, sum.lines, sum.length_mm,
                                            other));
    }
  };
  tell(our_own, "this reader", "the second one");
  tell(their_own, "the second reader", "this one");
}

}  // namespace

double Tolerance::lengthLimit_mm(double length_mm_, std::size_t lines, double extent_mm) const {
  return length_mm + length_share * length_mm_ +
         line_share * extent_mm * std::sqrt(static_cast<double>(lines));
}

Tolerance toleranceFor(FileFormat format) {
  if (format != FileFormat::kPdf) return {};
  // Two ends of a line, each with two coordinates that are rounded once and transformed once: four of the
  // format's roundings to either side. A matrix that is rounded changes all lengths alike.
  constexpr double kSingle = 5.960464477539063e-8;  // 2^-24
  return {.length_share = 2 * kSingle, .line_share = 4 * kSingle};
}

Comparison compareReadings(const dieline::Dieline& dieline, const SecondReading& second,
                           const dieline::DrawingOptions& options, FileFormat format) {
  Comparison result;
  const bool is_pdf = format == FileFormat::kPdf;
  Mapping mapping(options, format);
  for (const WitnessedLines& thing : second.unread) {
    if (is_pdf || mapping.of(thing, thing.what)) {
      result.partings.push_back(
          fmt::format("the second reader does not follow {} ({} of it), so that it cannot "
                      "tell its length",
                      base::inQuotes(thing.what), thing.count));
    }
  }
  Sums theirs;
  for (const WitnessedLines& lines : second.lines) {
    const auto known = mapping.of(lines, "a line that the second reader finds");
    if (!known) continue;
    LayerSum& sum = theirs[{base::lowered(known->first), known->second}];
    if (sum.layer.empty()) sum.layer = known->first;
    sum.add(lines.count, lines.length_mm, lines.box_mm);
  }
  if (const std::string faults = mapping.faults(); !faults.empty()) result.partings.push_back(faults);
  compareSums(ourSums(dieline, is_pdf), theirs, format, result);
  if (!result.partings.empty()) {
    for (const std::string& remark : second.remarks)
      result.partings.push_back(
          fmt::format("the second reader does not follow {}, which may be why", base::inQuotes(remark)));
  }
  return result;
}

}  // namespace kerfbench::witness
