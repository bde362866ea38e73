// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace kerfbench::dieline {

/// Reads SVG numbers from a list with blanks and commas between them.
class SvgScanner {
 public:
  explicit SvgScanner(std::string_view text) : text_(text) {}
  [[nodiscard]] bool atEnd();
  [[nodiscard]] std::size_t position() const { return at_; }
  /// The next number, or nothing (the position then stays before it).
  std::optional<double> number();
  /// An arc flag: a single 0 or 1, even where no blank follows it.
  std::optional<bool> flag();
  /// The next character that is no blank and no comma, if it is a letter.
  std::optional<char> letter();
  /// True when a number can start here.
  bool atNumber();

 private:
  void skipBlanks();
  std::string_view text_;
  std::size_t at_{};
};

/// A length in user units, of which `px_per_inch` are an inch; nothing for percentages, em and what is no
/// length.
std::optional<double> svgLength(std::string_view text, double px_per_inch = 96.0);
/// #rrggbb in lower case from a name, #rgb, #rrggbb or rgb(); "none" stays; nothing for what is no colour.
std::optional<std::string> svgColour(std::string_view text);
/// The value of a transform attribute.
std::optional<Eigen::Affine2d> svgTransform(std::string_view text);
/// Splits "a: b; c: d", names in lower case; semicolons in quotes and brackets do not split.
std::vector<std::pair<std::string, std::string>> svgDeclarations(std::string_view text);

/// A box to be fitted into another: viewBox with width, height and preserveAspectRatio.
struct SvgViewport {
  double width{};  ///< User units outside.
  double height{};
  std::optional<Eigen::AlignedBox2d> view_box;
  std::string aspect;
  /// Map from the inside to the outside, or nothing for an aspect that is not supported (slice) or a box
  /// without size.
  [[nodiscard]] std::optional<Eigen::Affine2d> fit() const;
};

}  // namespace kerfbench::dieline
