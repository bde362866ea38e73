// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_css.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include <pugixml.hpp>

#include "hil/dieline/svg_style.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\f";

struct PropertyName {
  const char* name;
  SvgProperty property;
};
constexpr std::array<PropertyName, 12> kPresentation{{{"transform", SvgProperty::kTransform},
                                                      {"color", SvgProperty::kColour},
                                                      {"stroke", SvgProperty::kStroke},
                                                      {"stroke-width", SvgProperty::kStrokeWidth},
                                                      {"stroke-opacity", SvgProperty::kStrokeOpacity},
                                                      {"stroke-dasharray", SvgProperty::kStrokeDashes},
                                                      {"opacity", SvgProperty::kOpacity},
                                                      {"display", SvgProperty::kDisplay},
                                                      {"visibility", SvgProperty::kVisibility},
                                                      {"overflow", SvgProperty::kOverflow},
                                                      {"clip-path", SvgProperty::kClipPath},
                                                      {"mask", SvgProperty::kMask}}};

std::optional<SvgProperty> propertyOf(std::string_view name) {
  for (const PropertyName& known : kPresentation) {
    if (name == known.name) return known.property;
  }
  for (const std::string_view geometry : {"d", "cx", "cy", "r", "rx", "ry", "x", "y"}) {
    if (name == geometry) return SvgProperty::kGeometry;
  }
  return std::nullopt;
}

bool isNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

std::string takeName(std::string_view& text) {
  std::string name;
  while (!text.empty() && (isNameCharacter(text.front()) || (text.front() == '\\' && text.size() > 1))) {
    if (text.front() == '\\') text.remove_prefix(1);  // An escaped character stands for itself.
    name += text.front();
    text.remove_prefix(1);
  }
  return name;
}

bool hasWord(std::string_view words, std::string_view word) {
  while (!(words = trimmed(words)).empty()) {
    const std::size_t end = std::min(words.find_first_of(kBlanks), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(end);
  }
  return false;
}

std::string withoutComments(std::string_view css) {
  std::string plain;
  for (std::size_t i = 0; i < css.size();) {
    if (css.substr(i).starts_with("/*")) {
      const std::size_t end = css.find("*/", i + 2);
      i = end == std::string_view::npos ? css.size() : end + 2;
      plain += ' ';
    } else if (css.substr(i).starts_with("<!--") || css.substr(i).starts_with("-->")) {
      i += css[i] == '<' ? 4 : 3;
    } else {
      plain += css[i++];
    }
  }
  return plain;
}

/// The end of the block that opens at `open`, or the size of the text.
std::size_t closingBrace(std::string_view text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (text[i] == '{') ++depth;
    if (text[i] == '}' && --depth == 0) return i;
  }
  return text.size();
}

constexpr std::string_view kSvgNamespace = "http://www.w3.org/2000/svg";

}  // namespace

std::string_view svgName(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) return name;
  const std::string declaration = "xmlns:" + std::string(name.substr(0, colon));
  for (pugi::xml_node at = node; at; at = at.parent()) {
    const std::string_view value = at.attribute(declaration.c_str()).value();
    if (value == kSvgNamespace || value == "&ns_svg;") return name.substr(colon + 1);
    if (!value.empty()) break;
  }
  return name;
}

bool SvgSheet::Strength::beats(const Strength& other) const {
  return std::tie(important, origin, specificity, order) >=
         std::tie(other.important, other.origin, other.specificity, other.order);
}

/// The winner of each property so far.
struct SvgSheet::Cascade {
  SvgStyle values;
  std::array<Strength, kSvgProperties> strengths{};

  void offer(const Declared& declared, Strength strength) {
    strength.important = declared.important;
    const auto at = static_cast<std::size_t>(declared.property);
    if (!strength.beats(strengths.at(at))) return;
    strengths.at(at) = strength;
    values.at(at) = declared.value;
  }
};

std::vector<SvgSheet::Declared> SvgSheet::declared(std::string_view text) {
  std::vector<Declared> result;
  for (auto& [name, value] : svgDeclarations(text)) {
    const auto property = propertyOf(name);
    if (!property) continue;
    bool important = false;
    if (const std::size_t mark = value.rfind('!'); mark != std::string::npos) {
      important = lowered(trimmed(std::string_view(value).substr(mark + 1))) == "important";
      value = std::string(trimmed(std::string_view(value).substr(0, mark)));
    }
    if (!value.empty()) result.push_back({*property, std::move(value), important});
  }
  return result;
}

bool SvgSheet::readAttribute(std::string_view text, Compound& compound) {
  Attribute attribute;
  text = trimmed(text);
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) {
    attribute = {std::string(text), '?', ""};
  } else {
    std::string_view name = text.substr(0, equals);
    std::string_view value = trimmed(text.substr(equals + 1));
    attribute.how = '=';
    if (!name.empty() && std::string_view("~|^$*").find(name.back()) != std::string_view::npos) {
      attribute.how = name.back();
      name.remove_suffix(1);
    }
    if (value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front())
      value = value.substr(1, value.size() - 2);
    attribute.name = trimmed(name);
    attribute.value = value;
  }
  compound.attributes.push_back(attribute);
  return !attribute.name.empty() && attribute.name.find_first_of("| ") == std::string::npos;
}

/// Takes one class, id, attribute or pseudo-class off the text. False for what is not known.
bool SvgSheet::readPart(std::string_view& text, Compound& compound, int& specificity) {
  const char kind = text.front();
  text.remove_prefix(1);
  if (kind == '[') {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos || !readAttribute(text.substr(0, end), compound)) return false;
    text.remove_prefix(end + 1);
    specificity += 100;
    return true;
  }
  const bool is_pseudo_element = kind == ':' && text.starts_with(':');
  if (is_pseudo_element) text.remove_prefix(1);
  const std::string name = takeName(text);
  if (name.empty()) return false;
  if (kind == '#') {
    compound.id = name;
    specificity += 10000;
    return true;
  }
  specificity += 100;
  if (kind == '.') {
    compound.classes.push_back(name);
    return true;
  }
  if (kind != ':' || text.starts_with('(')) return false;
  compound.is_root = compound.is_root || name == "root";
  const bool is_state = name == "hover" || name == "active" || name == "focus" || name == "visited" ||
                        name == "link" || is_pseudo_element;
  compound.is_never = compound.is_never || is_state;
  return is_state || name == "root";
}

bool SvgSheet::readSelector(std::string_view text, Rule& rule) {
  char before = 0;
  while (!(text = trimmed(text)).empty()) {
    if (text.front() == '>') {
      if (rule.compounds.empty() || before == '>') return false;
      before = '>';
      text.remove_prefix(1);
      continue;
    }
    Compound compound;
    compound.before = rule.compounds.empty() ? '\0' : before == '>' ? '>' : ' ';
    before = 0;
    if (text.front() == '*') {
      text.remove_prefix(1);
    } else if (isNameCharacter(text.front())) {
      compound.type = takeName(text);
      rule.specificity += 1;
    } else if (std::string_view(".#[:").find(text.front()) == std::string_view::npos) {
      return false;
    }
    while (!text.empty() && std::string_view(".#[:").find(text.front()) != std::string_view::npos) {
      if (!readPart(text, compound, rule.specificity)) return false;
    }
    if (!text.empty() && text.front() != '>' && kBlanks.find(text.front()) == std::string_view::npos)
      return false;
    rule.compounds.push_back(std::move(compound));
  }
  return !rule.compounds.empty() && before == 0;
}

std::vector<std::string> SvgSheet::add(std::string_view css) {
  std::vector<std::string> unknown;
  const std::string plain = withoutComments(css);
  std::string_view rest = plain;
  while (!(rest = trimmed(rest)).empty()) {
    const std::size_t open = rest.find('{');
    const std::size_t semicolon = rest.find(';');
    const std::string_view head = trimmed(rest.substr(0, std::min(open, semicolon)));
    if (rest.front() == '@') {
      if (head.starts_with("@media") || head.starts_with("@import") || head.starts_with("@supports"))
        unknown.emplace_back(head);
      const std::size_t end = semicolon < open ? semicolon : closingBrace(rest, std::min(open, rest.size()));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      continue;
    }
    if (open == std::string_view::npos) break;
    const std::size_t close = closingBrace(rest, open);
    std::vector<Declared> found = declared(rest.substr(open + 1, close - open - 1));
    std::string_view selectors = rest.substr(0, open);
    rest.remove_prefix(std::min(close + 1, rest.size()));
    if (found.empty()) continue;  // Fonts and fills do not matter here.
    declarations_.push_back(std::move(found));
    while (!selectors.empty()) {
      const std::size_t comma = std::min(selectors.find(','), selectors.size());
      const std::string_view one = trimmed(selectors.substr(0, comma));
      selectors.remove_prefix(std::min(comma + 1, selectors.size()));
      Rule rule;
      rule.declarations = declarations_.size() - 1;
      if (!readSelector(one, rule)) {
        unknown.emplace_back(one);
        continue;
      }
      index(rule.compounds.back(), rules_.size());
      rules_.push_back(std::move(rule));
    }
  }
  return unknown;
}

void SvgSheet::index(const Compound& last, std::size_t rule) {
  std::string key = "*";
  if (!last.id.empty())
    key = "#" + last.id;
  else if (!last.classes.empty())
    key = "." + last.classes.front();
  else if (!last.type.empty())
    key = last.type;
  by_key_[key].push_back(rule);
}

bool SvgSheet::matches(const pugi::xml_node& node, const Compound& compound) {
  if (compound.is_never || (!compound.type.empty() && svgName(node) != compound.type)) return false;
  if (compound.is_root && node.parent().type() != pugi::node_document) return false;
  if (!compound.id.empty() && compound.id != node.attribute("id").value()) return false;
  for (const std::string& one : compound.classes) {
    if (!hasWord(node.attribute("class").value(), one)) return false;
  }
  return std::all_of(compound.attributes.begin(), compound.attributes.end(), [&](const Attribute& wanted) {
    const pugi::xml_attribute attribute = node.attribute(wanted.name.c_str());
    const std::string_view value = attribute.value();
    const std::string_view part = wanted.value;
    if (!attribute) return false;
    switch (wanted.how) {
      case '=':
        return value == part;
      case '~':
        return hasWord(value, part);
      case '|':
        return value == part || value.starts_with(wanted.value + "-");
      case '^':
        return !part.empty() && value.starts_with(part);
      case '$':
        return !part.empty() && value.ends_with(part);
      case '*':
        return !part.empty() && value.find(part) != std::string_view::npos;
      default:
        return true;
    }
  });
}

/// True when the rule matches an element and its ancestors. All places of a compound are kept at once: trying
/// one after the other would take as many steps as there are ways up a deep tree.
bool SvgSheet::matches(const pugi::xml_node& node, const Rule& rule) {
  if (!matches(node, rule.compounds.back())) return false;
  if (rule.compounds.size() == 1) return true;
  std::vector<pugi::xml_node> way;
  for (pugi::xml_node at = node; at.type() == pugi::node_element; at = at.parent()) way.push_back(at);
  std::vector<bool> is_here(way.size(), false);
  is_here[0] = true;
  for (std::size_t k = rule.compounds.size() - 1; k > 0; --k) {
    const bool is_child = rule.compounds[k].before == '>';
    std::vector<bool> is_next(way.size(), false);
    bool was_below = false;
    for (std::size_t i = 1; i < way.size(); ++i) {
      was_below = is_here[i - 1] || (!is_child && was_below);
      is_next[i] = was_below && matches(way[i], rule.compounds[k - 1]);
    }
    is_here = std::move(is_next);
  }
  return std::find(is_here.begin(), is_here.end(), true) != is_here.end();
}

SvgStyle SvgSheet::styleOf(const pugi::xml_node& node) const {
  Cascade cascade;
  for (const PropertyName& known : kPresentation) {
    const std::string_view value = trimmed(node.attribute(known.name).value());
    if (!value.empty()) cascade.offer({known.property, std::string(value), false}, {false, 0, 0, 0});
  }
  const std::size_t class_bytes = std::string_view(node.attribute("class").value()).size();
  const auto offerRules = [&](const std::string& key) {
    const auto rules = by_key_.find(key);
    if (rules == by_key_.end()) return;
    for (const std::size_t index : rules->second) {
      steps_ += 1 + class_bytes;
      if (isExhausted()) return;
      const Rule& rule = rules_[index];
      if (!matches(node, rule)) continue;
      std::size_t order = index << 8U;
      for (const Declared& one : declarations_[rule.declarations])
        cascade.offer(one, {false, 1, rule.specificity, order++});
    }
  };
  if (!rules_.empty()) {
    offerRules("*");
    offerRules(std::string(svgName(node)));
    if (const auto id = node.attribute("id")) offerRules("#" + std::string(id.value()));
    std::string_view classes = node.attribute("class").value();
    while (!(classes = trimmed(classes)).empty()) {
      const std::size_t end = std::min(classes.find_first_of(kBlanks), classes.size());
      offerRules("." + std::string(classes.substr(0, end)));
      classes.remove_prefix(end);
    }
  }
  std::size_t order = 0;
  for (const Declared& one : declared(node.attribute("style").value()))
    cascade.offer(one, {false, 2, 0, order++});
  return std::move(cascade.values);
}

}  // namespace kerfbench::dieline
