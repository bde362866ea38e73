// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "hil/dieline/read.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

struct NamedKind {
  LintFinding::Kind kind;
  std::string_view name;
};
constexpr std::array<NamedKind, 7> kKinds{{{LintFinding::Kind::kDuplicate, "duplicate"},
                                           {LintFinding::Kind::kOverlap, "overlap"},
                                           {LintFinding::Kind::kGap, "gap"},
                                           {LintFinding::Kind::kZeroLength, "zero-length"},
                                           {LintFinding::Kind::kOpenOutline, "open-outline"},
                                           {LintFinding::Kind::kSuspiciousSize, "suspicious-size"},
                                           {LintFinding::Kind::kEmpty, "empty"}}};

}  // namespace

std::string_view lintName(LintFinding::Kind kind) {
  for (const NamedKind& known : kKinds) {
    if (known.kind == kind) return known.name;
  }
  return "?";
}

std::optional<LintFinding::Kind> lintKindFromName(std::string_view name) {
  const std::string word = lowered(name);
  for (const NamedKind& known : kKinds) {
    if (known.name == word) return known.kind;
  }
  return std::nullopt;
}

}  // namespace kerfbench::dieline
