// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "hil/dieline/faults.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

/// How a line is drawn, as LayerProfile::styled names it.
struct LineStyle {
  std::string colour;
  std::string linetype;
};

/// The one spelling of a colour: "1" and "red" become "#ff0000"; DXF colours 7 to 255 stay numbers. Nothing
/// for what is no colour.
std::optional<std::string> normalColour(std::string_view text);
/// The one spelling of a linetype: lower case, "continuous" for "solid".
std::string normalLinetype(std::string_view text);

/// Finds the process of lines and keeps, for layers without rules by style, how their lines are drawn.
class LayerCensus {
 public:
  explicit LayerCensus(const LayerProfile& profile) : profile_(profile) {}

  /// The process of a line, or nothing: no rule names its layer, which refuse() says, or none its style,
  /// which is a fault at the first line of that style.
  std::optional<Process> processOf(std::string_view layer, const LineStyle& style, int line,
                                   std::string_view element, FaultList& faults);
  /// Adds a fault for each layer that no rule names, and for each whose lines are drawn differently although
  /// no rule tells them apart.
  void refuse(FaultList& faults) const;

 private:
  struct Seen {
    std::optional<Process> process;  ///< What the plain rule says; nothing where no rule names the layer.
    const StyleRules* styled{};      ///< Rules by style; null without.
    std::map<std::pair<std::string, std::string>, int> first_lines;  ///< Colour, linetype -> line.
    std::string first_element;  ///< First line of a layer without a rule, as "LINE".
    int first_line{};
    std::size_t without_rule{};
  };
  void refuseMixed(const std::string& layer, const Seen& seen, FaultList& faults) const;
  std::optional<Process> byStyle(const StyleRules& rules, std::string_view layer, const LineStyle& style,
                                 int line, std::string_view element, FaultList& faults) const;

  const LayerProfile& profile_;
  std::map<std::string, Seen, std::less<>> seen_;
};

}  // namespace kerfbench::dieline
