// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/process.h"

namespace kerfbench::dieline {

/// Layer name or stroke colour (#rrggbb, lower case) -> process. A layer that no rule names is an error, so
/// that nothing is forgotten in silence; "*" is the rule for all others.
struct LayerProfile {
  std::string name;
  std::map<std::string, Process> rules;
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

/// Reads .dxf (ASCII, R12 to 2018) or .svg by its extension.
/// @throws DielineError with everything wrong listed at once.
Dieline readDieline(const std::filesystem::path& path, const LayerProfile& profile);

/// One remark of the checker.
struct LintFinding {
  enum class Kind { kDuplicate, kOverlap, kGap, kZeroLength, kOpenOutline, kSuspiciousSize, kEmpty };
  Kind kind{};
  bool is_error{};  ///< Errors make the dieline unfit to cut; the rest are warnings.
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  std::string layer;
  std::string message;  ///< One sentence with the entities, their origin and the measure.
};
std::vector<LintFinding> lintDieline(const Dieline& dieline);

}  // namespace kerfbench::dieline
