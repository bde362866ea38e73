// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hil/base/progress.h"
#include "hil/dieline/process.h"

namespace kerfbench::dieline {

/// What a layer's lines are for, told apart by how they are drawn.
struct StyleRules {
  /// Rules for colours: #rrggbb in lower case, or the number of a DXF colour above 6 (see normalColour()).
  std::map<std::string, Process> colour;
  /// Rules for names of linetypes, in lower case; "continuous" and "dashed" for an SVG.
  std::map<std::string, Process> linetype;
  /// Rules for colour and linetype, with a blank between them.
  std::map<std::string, Process> both;
  std::optional<Process> other;  ///< For lines of the layer that no rule above names.
};

/// Layer name or stroke colour (#rrggbb, lower case) -> process. A layer that no rule names is an error, so
/// that nothing is forgotten in silence; "*" is the rule for all others. Lines of one layer that are drawn
/// differently, by colour or linetype, are an error as well unless `styled` tells what they are for.
struct LayerProfile {
  std::string name;
  std::map<std::string, Process> rules;
  std::map<std::string, StyleRules> styled{};  ///< A layer is in one of the two maps.
};
/// The house's usual names: cut/CUT/dieline/0/#000000/#ff0000 cut; crease/#0000ff/#00ff00; halfcut, kiss;
/// perf; …
LayerProfile defaultLayerProfile();

/// The rule for a layer, upper and lower case alike, else the rule "*", else nothing.
std::optional<Process> processFor(const LayerProfile& profile, std::string_view layer);
/// True when the profile names this very layer, not just by "*".
bool hasRule(const LayerProfile& profile, std::string_view layer);

/// A file that cannot be read; what() lists every fault, each with file and line.
class DielineError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Length of one unit of a drawing, for files that do not say it or say it wrong.
enum class DrawingUnit { kMillimetre, kCentimetre, kInch, kPoint, kPixel };
/// Millimetres of a unit; a point is 1/72 inch, a pixel 1/96 inch (CSS 2.1, 4.3.2).
double millimetresOf(DrawingUnit unit);
/// "mm", "cm", "in", "pt" or "px"; nothing for anything else.
std::optional<DrawingUnit> drawingUnitFromName(std::string_view name);

/// How a drawing is to be read.
struct DrawingOptions {
  LayerProfile layers{defaultLayerProfile()};
  std::optional<DrawingUnit> unit{};  ///< Unit of the coordinates in the file; nothing: as the file says.
  std::optional<int> page{};          ///< Page of a PDF, from 1; nothing: the only one.
  /// The drawing is scaled and turned about the sheet's origin, then shifted. Range of the scale: > 0.
  double scale{1.0};
  double turn_deg{};  ///< Counter-clockwise.
  Eigen::Vector2d shift_mm{Eigen::Vector2d::Zero()};
  /// Lines that lie wholly on another of their process are left out, with a note.
  bool once{};
  base::ProgressFn progress{};  ///< Told now and then while a large file is read.
};

/// Adds a rule to a profile: {"CUT"}, {"CUT", "other"}, {"*", "color", "1"}, {"*", "linetype", "DASHED"} or
/// {"*", "both", "1 DASHED"}, each for a process by its name. Returns what is wrong, or nothing.
std::string addLayerRule(LayerProfile& profile, const std::vector<std::string>& path,
                         std::string_view process);

/// Options of a drawing as typed on a command line; empty: not told.
struct DrawingArguments {
  std::string unit;
  int page{};  ///< 0: not told.
  double scale{1.0};
  double turn_deg{};
  std::vector<double> shift_mm;  ///< Two numbers, or none.
  bool once{};
  std::vector<std::string>
      layers;  ///< Rules such as "CUT=cut" and "*/color/1=cut", in place of the usual names.
  /// True if nothing was told.
  [[nodiscard]] bool empty() const;
};
/// @throws DielineError for an unknown unit or process, a scale that is not > 0, a rule that is none.
DrawingOptions drawingOptionsFrom(const DrawingArguments& arguments);

/// Reads .dxf (ASCII, R12 to 2018) or .svg by its extension.
/// @throws DielineError with everything wrong listed at once.
Dieline readDieline(const std::filesystem::path& path, const DrawingOptions& options);
Dieline readDieline(const std::filesystem::path& path, const LayerProfile& profile);

/// One remark of the checker.
struct LintFinding {
  enum class Kind { kDuplicate, kOverlap, kGap, kZeroLength, kOpenOutline, kSuspiciousSize, kEmpty };
  Kind kind{};
  bool is_error{};  ///< Errors make the dieline unfit to cut; the rest are warnings.
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  std::string layer;
  std::string message;  ///< One sentence with the entities, their origin and the measure.
  /// True where nothing but lines that are not cut is wrong, or such a line on a cut: that may be accepted.
  bool may_be_accepted{};
  double size_mm{};  ///< Length that is wrong, mm; the larger, the worse.
  /// Ids of the entities that the message names, in its order; none where it is of the drawing as a whole.
  std::vector<int> entities{};
};
/// The worst findings, and how many there are of each kind.
struct LintReport {
  /// Sorted as the kinds are; of one kind, those that may not be accepted first, then by size, the largest
  /// first.
  std::vector<LintFinding> findings;
  struct Counts {
    std::size_t all{};
    std::size_t not_to_be_accepted{};  ///< Errors that may not be accepted.
  };
  std::map<LintFinding::Kind, Counts> counts;
};
constexpr std::size_t kAllFindings = static_cast<std::size_t>(-1);
/// Checks a drawing in n log n steps. `most`: findings that are kept of each kind, the worst. `progress` is
/// told of a check that takes long.
LintReport lintDieline(const Dieline& dieline, std::size_t most, const base::ProgressFn& progress = {});
/// All findings.
std::vector<LintFinding> lintDieline(const Dieline& dieline);

/// True for an error of an accepted kind that may be accepted.
bool isAccepted(const LintFinding& finding, const std::set<LintFinding::Kind>& accepted);
/// One sentence for each accepted kind that was found, with the number and the worst.
std::vector<std::string> acceptedSentences(const LintReport& report,
                                           const std::set<LintFinding::Kind>& accepted);
/// One sentence for each kind of which the report does not have all findings.
std::vector<std::string> uncounted(const LintReport& report);
/// What to do about cuts on each other, or nothing where there are none.
std::optional<std::string> adviceOnRepeats(const LintReport& report);

/// Name of a kind for people and options: "duplicate", "overlap", "gap", "zero-length", "open-outline",
/// "suspicious-size", "empty".
std::string_view lintName(LintFinding::Kind kind);
/// The kind of this name, upper and lower case alike.
std::optional<LintFinding::Kind> lintKindFromName(std::string_view name);

}  // namespace kerfbench::dieline
