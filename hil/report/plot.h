// SPDX-License-Identifier: Apache-2.0
#pragma once

// A small figure with scales, for the reports.

#include <string>
#include <vector>

namespace kerfbench::report {

/// SVG of kW x kH with linear scales; values beyond them lie at the rim.
class Plot {
 public:
  static constexpr double kW = 420.0;
  static constexpr double kH = 190.0;

  /// x0 < x1, y0 < y1.
  Plot(double x0, double x1, double y0, double y1, const std::string& label);

  [[nodiscard]] double x(double v) const;
  [[nodiscard]] double y(double v) const;
  void raw(const std::string& text) { svg_ += text; }
  /// `format` of each number, as of fmt.
  void xTicks(const std::vector<double>& at, const std::string& name, const char* format = "{:g}");
  void yTicks(const std::vector<double>& at, const char* format = "{:g}");
  void horizontal(double v, const char* css_class);
  void vertical(double v, const char* css_class);
  /// The whole figure; `caption` is HTML.
  [[nodiscard]] std::string figure(const std::string& caption) const;

 private:
  double x0_, x1_, y0_, y1_;
  std::string svg_;
};

/// Round numbers within [from, to], four to ten of them; from < to.
std::vector<double> ticks(double from, double to);

}  // namespace kerfbench::report
