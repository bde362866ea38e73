// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include <fmt/format.h>

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

bool isAccepted(const LintFinding& finding, const std::set<LintFinding::Kind>& accepted) {
  return finding.is_error && finding.may_be_accepted && accepted.contains(finding.kind);
}

std::vector<std::string> acceptedSentences(const LintReport& report,
                                           const std::set<LintFinding::Kind>& accepted) {
  std::vector<std::string> sentences;
  for (const LintFinding::Kind kind : accepted) {
    const auto counts = report.counts.find(kind);
    if (counts == report.counts.end()) continue;
    const std::size_t count = counts->second.all - counts->second.not_to_be_accepted;
    const auto worst =
        std::find_if(report.findings.begin(), report.findings.end(),
                     [&](const LintFinding& f) { return f.kind == kind && isAccepted(f, accepted); });
    if (count == 0) continue;
    sentences.push_back(fmt::format("{}: {} accepted", lintName(kind), count));
    if (worst != report.findings.end()) sentences.back() += fmt::format(", the worst: {}", worst->message);
  }
  return sentences;
}

std::vector<std::string> uncounted(const LintReport& report) {
  std::vector<std::string> sentences;
  for (const auto& [kind, counts] : report.counts) {
    const auto told = static_cast<std::size_t>(
        std::count_if(report.findings.begin(), report.findings.end(),
                      [kind = kind](const LintFinding& finding) { return finding.kind == kind; }));
    if (told < counts.all)
      sentences.push_back(
          fmt::format("{}: and {} more that are no worse", lintName(kind), counts.all - told));
  }
  return sentences;
}

std::optional<std::string> adviceOnRepeats(const LintReport& report) {
  const auto isRepeat = [](const auto& entry) {
    const bool is_of_two =
        entry.first == LintFinding::Kind::kDuplicate || entry.first == LintFinding::Kind::kOverlap;
    return is_of_two && entry.second.not_to_be_accepted > 0;
  };
  if (std::none_of(report.counts.begin(), report.counts.end(), isRepeat)) return std::nullopt;
  return "cuts on each other would be cut twice: dieline: {once: true} (--once) leaves out each that lies "
         "wholly on "
         "another";
}

}  // namespace kerfbench::dieline
