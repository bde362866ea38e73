// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace kerfbench::validation {

/// One figure that was measured now, against its limit.
struct Claim {
  enum class Relation { kAtMost, kAtLeast };

  std::string says;  ///< Claim in words: "largest error of the spot at 10 us".
  double measured{};
  Relation relation{Relation::kAtMost};
  double limit{};
  std::string unit;
  /// Value below which the figure is rounding and the page says so instead of digits that a library may
  /// change.
  double floor{};

  /// Whether the claim holds; false for NaN.
  [[nodiscard]] bool holds() const;
};

/// A picture of the page: a whole SVG document.
struct Figure {
  std::string name;  ///< File name without ending: "galvo-step".
  std::string says;  ///< Caption.
  std::string svg;
};

/// A part of VALIDATION.md: text, claims with their limits, pictures.
struct Section {
  std::string title;
  std::string markdown;  ///< Text and tables before the claims.
  std::vector<Claim> claims;
  std::vector<Figure> figures;

  void atMost(std::string says, double measured, double limit, std::string unit, double floor = 0.0);
  void atLeast(std::string says, double measured, double limit, std::string unit);
  /// True if every claim holds. A section without claims proves nothing and does not pass.
  [[nodiscard]] bool pass() const;
};

/// Raises `worst` to `value`; a NaN is the worst of all and stays.
void raiseTo(double& worst, double value);

/// A table in Markdown, columns aligned to the right but for the first.
std::string markdownTable(const std::vector<std::string>& head,
                          const std::vector<std::vector<std::string>>& rows);
/// Number with three significant digits; "< floor" below the floor.
std::string figureText(double value, double floor = 0.0);

}  // namespace kerfbench::validation
