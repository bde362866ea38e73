// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/section.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kerfbench::validation {

bool Claim::holds() const { return relation == Relation::kAtMost ? measured <= limit : measured >= limit; }

void Section::atMost(std::string says, double measured, double limit, std::string unit, double floor) {
  claims.push_back({std::move(says), measured, Claim::Relation::kAtMost, limit, std::move(unit), floor});
}

void Section::atLeast(std::string says, double measured, double limit, std::string unit) {
  claims.push_back({std::move(says), measured, Claim::Relation::kAtLeast, limit, std::move(unit), 0.0});
}

bool Section::pass() const { return !claims.empty() && std::ranges::all_of(claims, &Claim::holds); }

void raiseTo(double& worst, double value) {
  if (std::isnan(worst) || value <= worst) return;
  worst = value;
}

std::string markdownTable(const std::vector<std::string>& head,
                          const std::vector<std::vector<std::string>>& rows) {
  std::string text = fmt::format("| {} |\n|---", fmt::join(head, " | "));
  for (std::size_t i = 1; i < head.size(); ++i) text += "|---:";
  text += "|\n";
  for (const auto& row : rows) text += fmt::format("| {} |\n", fmt::join(row, " | "));
  return text + "\n";
}

std::string figureText(double value, double floor) {
  if (std::abs(value) < floor) return fmt::format("< {:g}", floor);
  return fmt::format("{:.3g}", value);
}

}  // namespace kerfbench::validation
