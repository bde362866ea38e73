// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/ignored_layers.h"

#include <map>

#include <fmt/format.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {

void noteIgnoredLayers(Dieline& dieline) {
  std::map<std::string_view, std::size_t> counts;
  for (const Entity& entity : dieline.entities) {
    if (entity.process == Process::kIgnore) ++counts[entity.layer];
  }
  for (const auto& [layer, count] : counts)
    dieline.notes.push_back(fmt::format("Ignored by its rule: layer {}, {} lines.", inQuotes(layer), count));
}

}  // namespace kerfbench::dieline
