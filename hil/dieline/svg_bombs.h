// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "hil/dieline/faults.h"

namespace pugi {
class xml_node;
}  // namespace pugi

namespace kerfbench::dieline {

/// Elements by their id.
using SvgIds = std::unordered_map<std::string, pugi::xml_node>;

/// The element that a `use` refers to, or a null node.
pugi::xml_node svgUsed(const pugi::xml_node& use, const SvgIds& ids);

/// Counts the elements and attributes of a file, which its tree would take 64 and 40 bytes for.
/// @throws DielineError where they are more than kMostElements or kMostAttributes.
void refuseLargeXml(std::string_view text, FaultList& faults);

/// Counts what the `use` elements of a file unfold to, without unfolding.
/// @throws DielineError where uses hold themselves, are nested deeper than kDeepestNesting, or unfold to more
/// than kMostElements. `line_of`: line of an element.
void refuseSvgBombs(const pugi::xml_node& root, const SvgIds& ids,
                    const std::function<int(const pugi::xml_node&)>& line_of, FaultList& faults);

}  // namespace kerfbench::dieline
