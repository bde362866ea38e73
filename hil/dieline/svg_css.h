// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pugi {
class xml_node;
}  // namespace pugi

namespace kerfbench::dieline {

/// Properties of CSS by which a line is drawn or not, and those that would move its points.
enum class SvgProperty {
  kTransform,  ///< Before the clip, which is in the frame that it makes.
  kColour,     ///< Before the stroke, which may refer to it.
  kStroke,
  kStrokeWidth,
  kStrokeOpacity,
  kStrokeDashes,
  kOpacity,
  kDisplay,
  kVisibility,
  kOverflow,
  kClipPath,
  kMask,
  kGeometry,  ///< A point or size that a rule sets (SVG 2, 7.2), which is not read.
  kCount
};
constexpr std::size_t kSvgProperties = static_cast<std::size_t>(SvgProperty::kCount);

/// Value of each property that an element is given; empty where it is given none.
using SvgStyle = std::array<std::string, kSvgProperties>;

/// Name of an element without the prefix of SVG's own namespace ("svg:path" is a path). Prefixes of other
/// programs stay.
std::string_view svgName(const pugi::xml_node& node);

/// The rules of <style> elements, and which of them an element gets: the cascade of CSS 2.1, 6.4.
class SvgSheet {
 public:
  /// Adds a sheet, after those before. Returns what it cannot read and what could matter: selectors of
  /// siblings, pseudo-classes, @media, @import.
  std::vector<std::string> add(std::string_view css);

  /// Attributes of presentation are weakest, then rules by specificity and order, then the style attribute;
  /// what is !important is stronger than all that is not.
  [[nodiscard]] SvgStyle styleOf(const pugi::xml_node& node) const;

  /// Most bytes of classes that the rules of a file are held against, an element and a rule at a time. A
  /// drawing of 100 MB with twenty rules takes half of it.
  static constexpr std::size_t kMostSteps = 200'000'000;
  /// More than that was asked for: rules have been left out since.
  [[nodiscard]] bool isExhausted() const { return steps_ > kMostSteps; }

 private:
  struct Attribute {
    std::string name;
    char how{};  ///< '?' is present, '=' equals, '~' is a word of, '|', '^', '$', '*' as in CSS.
    std::string value;
  };
  /// What is asked of one element.
  struct Compound {
    std::string type;
    std::string id;
    std::vector<std::string> classes;
    std::vector<Attribute> attributes;
    bool is_root{};
    bool is_never{};  ///< A state of the screen, such as :hover.
    char before{};    ///< ' ' or '>' to the compound on its left.
  };
  struct Declared {
    SvgProperty property{};
    std::string value;
    bool important{};
  };
  struct Rule {
    std::vector<Compound> compounds;  ///< From left to right.
    int specificity{};
    std::size_t declarations{};  ///< Index into declarations_.
  };
  struct Strength {
    bool important{};
    int origin{-1};
    int specificity{};
    std::size_t order{};
    [[nodiscard]] bool beats(const Strength& other) const;
  };
  struct Cascade;

  static std::vector<Declared> declared(std::string_view text);
  static bool readSelector(std::string_view text, Rule& rule);
  static bool readPart(std::string_view& text, Compound& compound, int& specificity);
  static bool readAttribute(std::string_view text, Compound& compound);
  [[nodiscard]] static bool matches(const pugi::xml_node& node, const Compound& compound);
  [[nodiscard]] static bool matches(const pugi::xml_node& node, const Rule& rule);
  void index(const Compound& last, std::size_t rule);

  mutable std::size_t steps_{};
  std::vector<std::vector<Declared>> declarations_;
  std::vector<Rule> rules_;
  /// Rules by what their last compound asks for first: "#id", ".class", "type" or "*".
  std::unordered_map<std::string, std::vector<std::size_t>> by_key_;
};

}  // namespace kerfbench::dieline
