// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_context.h"

#include <algorithm>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

class Applier {
 public:
  explicit Applier(SvgContext& context) : context_(context) {}

  void apply(SvgProperty property, const std::string& value) {
    const std::string word = lowered(value);
    const bool is_initial = word == "initial";
    const bool is_inherited = word == "inherit" || word == "unset";
    switch (property) {
      case SvgProperty::kTransform:
        if (word != "none" && !is_initial) transform(value);
        break;
      case SvgProperty::kColour:
        if (const auto colour = svgColour(value); colour && colour != "none") context_.colour = *colour;
        break;
      case SvgProperty::kStroke:
        if (!is_inherited) stroke(is_initial ? "none" : value);
        break;
      case SvgProperty::kStrokeWidth:
        if (!is_inherited) context_.has_width = is_initial || !isZero(value);
        break;
      case SvgProperty::kStrokeOpacity:
        if (!is_inherited) context_.is_opaque_stroke = is_initial || !isZero(value);
        break;
      case SvgProperty::kStrokeDashes:
        if (!is_inherited) context_.is_dashed = !is_initial && word != "none" && hasDashes(value);
        break;
      case SvgProperty::kOpacity:
        context_.is_faded = context_.is_faded || isZero(value);
        break;
      case SvgProperty::kDisplay:
        context_.is_displayed = word != "none";
        break;
      case SvgProperty::kVisibility:
        if (!is_inherited) context_.is_visible = is_initial || word == "visible";
        break;
      case SvgProperty::kOverflow:
        context_.overflows = word == "visible" || word == "auto";
        break;
      case SvgProperty::kClipPath:
        if (word != "none" && !is_initial) context_.clip_path = value;
        break;
      case SvgProperty::kMask:
        if (word != "none" && !is_initial) context_.clips.push_back({{}, "mask " + inQuotes(value)});
        break;
      case SvgProperty::kGeometry:
        fault("a style sheet moves its points, which is not read; put them into attributes");
        break;
      case SvgProperty::kCount:
        break;
    }
  }

 private:
  void fault(const std::string& text) { context_.faults += (context_.faults.empty() ? "" : "; ") + text; }

  void transform(const std::string& value) {
    const auto X = svgTransform(value);
    if (!X) fault(fmt::format("transform is broken: {}", inQuotes(value)));
    context_.X = context_.X * X.value_or(Eigen::Affine2d::Identity());
  }

  void stroke(const std::string& value) {
    const auto colour = lowered(value) == "currentcolor" ? context_.colour : svgColour(value);
    context_.stroke = colour.value_or("?" + value);
  }

  static bool isZero(std::string_view value) {
    SvgScanner scanner(value);
    return scanner.number() == 0.0;
  }

  /// Dashes of any length but 0.
  static bool hasDashes(std::string_view value) {
    return value.find_first_of("123456789") != std::string_view::npos;
  }

  SvgContext& context_;
};

}  // namespace

SvgContext svgInside(SvgContext outer, const SvgStyle& style) {
  outer.overflows = false;
  outer.clip_path.clear();
  outer.faults.clear();
  Applier applier(outer);
  for (std::size_t i = 0; i < kSvgProperties; ++i) {
    if (!style.at(i).empty()) applier.apply(static_cast<SvgProperty>(i), style.at(i));
  }
  return outer;
}

bool svgConditionsHold(const pugi::xml_node& node) {
  if (node.attribute("requiredExtensions")) return false;
  const auto languages = node.attribute("systemLanguage");
  if (!languages) return true;
  std::string_view rest = languages.value();
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string one = lowered(trimmed(rest.substr(0, comma)));
    if (one == "en" || one.starts_with("en-")) return true;
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return false;
}

}  // namespace kerfbench::dieline
