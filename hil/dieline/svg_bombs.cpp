// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/svg_bombs.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "hil/dieline/readers.h"
#include "hil/dieline/svg_css.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// What an element unfolds to.
struct SvgUnfolded {
  double count{};  ///< Elements; may be far above any integer.
  int height{};    ///< Levels of `use`.
};

class SvgCounter {
 public:
  SvgCounter(const SvgIds& ids, const std::function<int(const pugi::xml_node&)>& line_of, FaultList& faults)
      : ids_(ids), line_of_(line_of), faults_(faults) {}

  SvgUnfolded count(const pugi::xml_node& node, int depth) {
    SvgUnfolded sum{1, 0};
    const auto add = [&](const SvgUnfolded& inner) {
      sum.count += inner.count;
      sum.height = std::max(sum.height, inner.height);
    };
    refuseManyAttributes(node);
    const std::string_view name = svgName(node);
    if (name == "use") add(countUse(node, depth));
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view inner = svgName(child);
      if (inner != "defs" && inner != "symbol") add(count(child, depth));
    }
    if (sum.count > static_cast<double>(kMostElements))
      faults_.fatal(line_of_(node), fmt::format("more than {} elements", kMostElements));
    return sum;
  }

 private:
  /// A `use` has them looked through each time.
  void refuseManyAttributes(const pugi::xml_node& node) const {
    std::size_t attributes = 0;
    for (pugi::xml_attribute at = node.first_attribute(); at && attributes <= kMostOfElement;
         at = at.next_attribute())
      ++attributes;
    if (attributes > kMostOfElement)
      faults_.fatal(line_of_(node), fmt::format("an element of more than {} attributes", kMostOfElement));
  }

  SvgUnfolded countUse(const pugi::xml_node& use, int depth) {
    const pugi::xml_node target = svgUsed(use, ids_);
    if (!target) return {};
    const auto known = known_.find(target.internal_object());
    const int height = known == known_.end() ? 0 : known->second.height;
    if (depth + height >= kDeepestNesting) {
      faults_.fatal(line_of_(use), fmt::format("use of {} is nested deeper than {}: does it hold itself?",
                                               inQuotes(target.attribute("id").value()), kDeepestNesting));
    }
    if (known != known_.end()) return known->second;
    SvgUnfolded inner = count(target, depth + 1);
    ++inner.height;
    known_.emplace(target.internal_object(), inner);
    return inner;
  }

  const SvgIds& ids_;
  const std::function<int(const pugi::xml_node&)>& line_of_;
  FaultList& faults_;
  std::unordered_map<const void*, SvgUnfolded> known_;
};

}  // namespace

pugi::xml_node svgUsed(const pugi::xml_node& use, const SvgIds& ids) {
  std::string_view reference = trimmed(use.attribute("href").value());
  if (reference.empty()) reference = trimmed(use.attribute("xlink:href").value());
  if (!reference.starts_with('#')) return {};
  const auto found = ids.find(std::string(reference.substr(1)));
  return found == ids.end() ? pugi::xml_node() : found->second;
}

void refuseLargeXml(std::string_view text, FaultList& faults) {
  std::size_t elements = 0;
  std::size_t attributes = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '=') ++attributes;
    if (text[i] == '<' && text[i + 1] != '/') ++elements;
  }
  if (elements > kMostElements) faults.fatal(0, fmt::format("more than {} elements", kMostElements));
  if (attributes > kMostAttributes) faults.fatal(0, fmt::format("more than {} attributes", kMostAttributes));
}

void refuseSvgBombs(const pugi::xml_node& root, const SvgIds& ids,
                    const std::function<int(const pugi::xml_node&)>& line_of, FaultList& faults) {
  SvgCounter(ids, line_of, faults).count(root, 0);
}

}  // namespace kerfbench::dieline
