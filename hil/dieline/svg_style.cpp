// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

struct NamedColour {
  std::string_view name;
  std::string_view hex;
};
/// The 16 names of CSS 1 and those that drawing programs write besides.
constexpr std::array<NamedColour, 24> kColours{{
    {"black", "#000000"},   {"silver", "#c0c0c0"},  {"gray", "#808080"},    {"grey", "#808080"},
    {"white", "#ffffff"},   {"maroon", "#800000"},  {"red", "#ff0000"},     {"purple", "#800080"},
    {"fuchsia", "#ff00ff"}, {"magenta", "#ff00ff"}, {"green", "#008000"},   {"lime", "#00ff00"},
    {"olive", "#808000"},   {"yellow", "#ffff00"},  {"navy", "#000080"},    {"blue", "#0000ff"},
    {"teal", "#008080"},    {"aqua", "#00ffff"},    {"cyan", "#00ffff"},    {"orange", "#ffa500"},
    {"brown", "#a52a2a"},   {"pink", "#ffc0cb"},    {"darkred", "#8b0000"}, {"darkblue", "#00008b"},
}};

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

void SvgScanner::skipBlanks() {
  while (at_ < text_.size() && (isBlank(text_[at_]) || text_[at_] == ',')) ++at_;
}

bool SvgScanner::atEnd() {
  skipBlanks();
  return at_ >= text_.size();
}

bool SvgScanner::atNumber() {
  skipBlanks();
  return at_ < text_.size() &&
         (isDigit(text_[at_]) || text_[at_] == '.' || text_[at_] == '-' || text_[at_] == '+');
}

std::optional<double> SvgScanner::number() {
  skipBlanks();
  // Cut by SVG's grammar, which from_chars does not know: "1.5.5" is two numbers, "1em" a number and a unit.
  std::size_t end = at_;
  const auto digits = [&] {
    const std::size_t from = end;
    while (end < text_.size() && isDigit(text_[end])) ++end;
    return end > from;
  };
  if (end < text_.size() && (text_[end] == '+' || text_[end] == '-')) ++end;
  bool any = digits();
  if (end < text_.size() && text_[end] == '.') {
    ++end;
    any = digits() || any;
  }
  if (!any) return std::nullopt;
  if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
    const std::size_t mantissa_end = end++;
    if (end < text_.size() && (text_[end] == '+' || text_[end] == '-')) ++end;
    if (!digits()) end = mantissa_end;
  }
  const auto value = parsedNumber<double>(text_.substr(at_, end - at_));
  if (!value || std::abs(*value) > 1e9) return std::nullopt;
  at_ = end;
  return value;
}

std::optional<bool> SvgScanner::flag() {
  skipBlanks();
  if (at_ >= text_.size() || (text_[at_] != '0' && text_[at_] != '1')) return std::nullopt;
  return text_[at_++] == '1';
}

std::optional<char> SvgScanner::letter() {
  skipBlanks();
  if (at_ >= text_.size()) return std::nullopt;
  const char c = text_[at_];
  if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))) return std::nullopt;
  ++at_;
  return c;
}

std::optional<double> svgLength(std::string_view text, double px_per_inch) {
  text = trimmed(text);
  SvgScanner scanner(text);
  const auto value = scanner.number();
  if (!value) return std::nullopt;
  const std::string unit = lowered(text.substr(scanner.position()));
  if (unit.empty() || unit == "px") return value;
  if (unit == "mm") return *value * px_per_inch / 25.4;
  if (unit == "cm") return *value * px_per_inch / 2.54;
  if (unit == "in") return *value * px_per_inch;
  if (unit == "pt") return *value * px_per_inch / 72;
  if (unit == "pc") return *value * px_per_inch / 6;
  return std::nullopt;
}

std::optional<std::string> svgColour(std::string_view text) {
  std::string colour = lowered(trimmed(text));
  if (colour == "none" || colour == "transparent") return "none";
  if (colour.starts_with('#')) {
    if (!std::all_of(colour.begin() + 1, colour.end(),
                     [](char c) { return isDigit(c) || (c >= 'a' && c <= 'f'); }))
      return {};
    if (colour.size() == 7) return colour;
    if (colour.size() != 4) return std::nullopt;
    return std::string{'#', colour[1], colour[1], colour[2], colour[2], colour[3], colour[3]};
  }
  const bool has_alpha = colour.starts_with("rgba(");
  if ((colour.starts_with("rgb(") || has_alpha) && colour.ends_with(')')) {
    const std::size_t open = colour.find('(') + 1;
    std::string inside = colour.substr(open, colour.size() - open - 1);
    const bool percent = inside.find('%') != std::string::npos;
    std::replace(inside.begin(), inside.end(), '%', ' ');
    SvgScanner scanner(inside);
    std::string hex = "#";
    for (int i = 0; i < 3; ++i) {
      const auto part = scanner.number();
      if (!part) return std::nullopt;
      hex += fmt::format("{:02x}", std::lround(std::clamp(percent ? *part * 2.55 : *part, 0.0, 255.0)));
    }
    if (has_alpha && scanner.number() == 0.0) return "none";
    if (!scanner.atEnd()) return std::nullopt;
    return hex;
  }
  for (const NamedColour& named : kColours) {
    if (named.name == colour) return std::string(named.hex);
  }
  return std::nullopt;
}

std::optional<Eigen::Affine2d> svgTransform(std::string_view text) {
  Eigen::Affine2d X = Eigen::Affine2d::Identity();
  constexpr std::string_view kSeparators = " \t\r\n\f,";
  while (true) {
    const std::size_t start = text.find_first_not_of(kSeparators);
    if (start == std::string_view::npos) return X;
    const std::size_t open = text.find('(');
    const std::size_t close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open || open < start)
      return std::nullopt;
    const std::string_view name = trimmed(text.substr(start, open - start));
    SvgScanner scanner(text.substr(open + 1, close - open - 1));
    std::vector<double> v;
    while (const auto value = scanner.number()) v.push_back(*value);
    if (!scanner.atEnd()) return std::nullopt;
    const double degree = std::numbers::pi / 180;
    Eigen::Affine2d step = Eigen::Affine2d::Identity();
    if (name == "matrix" && v.size() == 6) {
      step.matrix().topRows<2>() << v[0], v[2], v[4], v[1], v[3], v[5];
    } else if (name == "translate" && (v.size() == 1 || v.size() == 2)) {
      step.translate(Eigen::Vector2d(v[0], v.size() == 2 ? v[1] : 0.0));
    } else if (name == "scale" && (v.size() == 1 || v.size() == 2)) {
      step.scale(Eigen::Vector2d(v[0], v.back()));
    } else if (name == "rotate" && v.size() == 1) {
      step.rotate(v[0] * degree);
    } else if (name == "rotate" && v.size() == 3) {
      step.translate(Eigen::Vector2d(v[1], v[2]))
          .rotate(v[0] * degree)
          .translate(Eigen::Vector2d(-v[1], -v[2]));
    } else if (name == "skewX" && v.size() == 1) {
      step.linear()(0, 1) = std::tan(v[0] * degree);
    } else if (name == "skewY" && v.size() == 1) {
      step.linear()(1, 0) = std::tan(v[0] * degree);
    } else {
      return std::nullopt;
    }
    X = X * step;
    text.remove_prefix(close + 1);
  }
}

std::vector<std::pair<std::string, std::string>> svgDeclarations(std::string_view text) {
  std::vector<std::pair<std::string, std::string>> declarations;
  while (!text.empty()) {
    std::size_t end = 0;
    int brackets = 0;
    char quote = 0;
    for (; end < text.size(); ++end) {
      const char c = text[end];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '(' || c == ')') {
        brackets += c == '(' ? 1 : -1;
      } else if (c == ';' && brackets <= 0) {
        break;
      }
    }
    const std::string_view one = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t colon = one.find(':');
    if (colon == std::string_view::npos) continue;
    declarations.emplace_back(lowered(trimmed(one.substr(0, colon))),
                              std::string(trimmed(one.substr(colon + 1))));
  }
  return declarations;
}

std::optional<Eigen::Affine2d> SvgViewport::fit() const {
  Eigen::Affine2d X = Eigen::Affine2d::Identity();
  if (!view_box) return X;
  const Eigen::Vector2d size = view_box->sizes();
  if (!(size.x() > 0) || !(size.y() > 0) || !(width > 0) || !(height > 0)) return std::nullopt;
  Eigen::Vector2d scale(width / size.x(), height / size.y());
  Eigen::Vector2d offset(0, 0);
  const std::string_view how = trimmed(aspect);
  if (how.find("slice") != std::string_view::npos) return std::nullopt;
  if (!how.starts_with("none")) {
    scale.setConstant(scale.minCoeff());
    const Eigen::Vector2d spare = Eigen::Vector2d(width, height) - scale.cwiseProduct(size);
    const auto share = [&](std::string_view low, std::string_view high) {
      if (how.find(low) != std::string_view::npos) return 0.0;
      return how.find(high) != std::string_view::npos ? 1.0 : 0.5;
    };
    offset = {spare.x() * share("xMin", "xMax"), spare.y() * share("YMin", "YMax")};
  }
  X.translate(offset).scale(scale).translate(-view_box->min());
  return X;
}

}  // namespace kerfbench::dieline
