// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "hil/dieline/dxf_tags.h"
#include "hil/dieline/layer_styles.h"

namespace kerfbench::dieline {

/// A layer of the table LAYER.
struct DxfLayer {
  LineStyle style{"7", "continuous"};
  bool is_frozen{};
  bool is_off{};
  bool is_plotted{true};
};

/// What an entity of a block takes from the INSERT; empty at the top of the drawing.
struct DxfInherited {
  std::string layer;                   ///< In place of layer 0.
  LineStyle style{"7", "continuous"};  ///< In place of BYBLOCK.
};

/// Layer, colour and linetype of an entity, as its program shows them.
struct DxfLook {
  std::string layer;
  LineStyle style;
  bool is_hidden{};    ///< Group 60.
  bool is_on_paper{};  ///< Group 67: part of a layout, not of the drawing.
};

/// Layers and clips of a file, and what entities get from them.
class DxfLooks {
 public:
  /// `file` must outlive the object.
  DxfLooks(const DxfFile& file, FaultList& faults);

  [[nodiscard]] DxfLook lookOf(const DxfRecord& record, const DxfInherited& inherited) const;
  /// The layer, or one that is shown where the table does not have it.
  [[nodiscard]] const DxfLayer& layer(std::string_view name) const;
  /// True where a SPATIAL_FILTER that is switched on clips an INSERT (AutoCAD's XCLIP).
  [[nodiscard]] bool isClipped(const DxfRecord& insert) const;

 private:
  [[nodiscard]] const DxfRecord* entryOf(std::string_view dictionary, std::string_view name) const;

  std::map<std::string, DxfLayer, std::less<>> layers_;   ///< Layers by name in lower case.
  std::map<std::string_view, const DxfRecord*> objects_;  ///< DICTIONARY and SPATIAL_FILTER by handle.
  DxfLayer unknown_;
};

}  // namespace kerfbench::dieline
