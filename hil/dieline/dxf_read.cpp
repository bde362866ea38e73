// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil/dieline/dxf_entities.h"
#include "hil/dieline/dxf_tags.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// Millimetres per drawing unit. $INSUNITS decides; a file without it (R12) that says $MEASUREMENT = 0 is in
/// inches; all else is unitless, which means mm in this trade.
double unitOf(const DxfFile& file, FaultList& faults) {
  const auto variable = [&](std::string_view name) -> std::optional<int> {
    const auto it = file.header.find(name);
    if (it == file.header.end()) return std::nullopt;
    const auto value = parsedNumber<int>(it->second.text);
    if (!value)
      faults.add(it->second.line, fmt::format("{} is no integer: {}", name, inQuotes(it->second.text)));
    return value;
  };
  const auto units = variable("$INSUNITS");
  if (!units) return variable("$MEASUREMENT") == 0 ? 25.4 : 1.0;
  switch (*units) {
    case 0:
    case 4:
      return 1.0;
    case 1:
      return 25.4;
    case 5:
      return 10.0;
    case 6:
      return 1000.0;
    default:
      faults.add(
          file.header.find("$INSUNITS")->second.line,
          fmt::format("$INSUNITS {} is not supported; inch (1), mm (4), cm (5), m (6) and none (0) are",
                      *units));
      return 1.0;
  }
}

class Unfolder {
 public:
  Unfolder(const DxfFile& file, const LayerProfile& profile, FaultList& faults, Dieline& dieline)
      : file_(file), profile_(profile), faults_(faults), dieline_(dieline) {}

  /// `inherited_layer` replaces layer 0 of what a block holds; empty at the top.
  void unfold(const std::vector<DxfRecord>& records, const Eigen::Affine2d& X,
              const std::string& inherited_layer, int depth) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      const DxfRecord& record = records[i];
      if (++steps_ > kMostEntities)
        faults_.fatal(record.line(), fmt::format("more than {} entities", kMostEntities));
      const DxfFields fields(record, faults_);
      const std::string_view type = record.type();
      // Parts of the entity before them, and the paper the drawing is laid out on, are no part of the
      // dieline.
      if (type == "VERTEX" || type == "SEQEND" || type == "ATTRIB" || type == "ATTDEF" || type == "VIEWPORT")
        continue;
      if (fields.integer(67, 0) == 1) continue;
      std::string layer(fields.text(8, "0"));
      if (layer == "0" && !inherited_layer.empty()) layer = inherited_layer;
      try {
        if (type == "INSERT") {
          insert(record, fields, X, layer, depth);
        } else {
          curves(records, i, X, layer);
        }
      } catch (const DxfUnsupported& unsupported) {
        const auto process = processFor(profile_, layer);
        if (process != Process::kIgnore) {
          faults_.add(record.line(), fmt::format("{} (layer {})", unsupported.what(), inQuotes(layer)));
        }
      }
    }
  }

 private:
  void curves(const std::vector<DxfRecord>& records, std::size_t index, const Eigen::Affine2d& X,
              const std::string& layer) {
    const auto process = processFor(profile_, layer);
    if (!process) {
      faults_.add(records[index].line(),
                  fmt::format("{} on layer {}, for which the profile {} has no rule", records[index].type(),
                              inQuotes(layer), inQuotes(profile_.name)));
    }
    for (DxfCurve& found : dxfCurves(records, index, faults_)) {
      if (dieline_.entities.size() >= kMostEntities) {
        faults_.fatal(records[index].line(), fmt::format("more than {} entities", kMostEntities));
      }
      if (!process) continue;
      dieline_.entities.push_back({static_cast<int>(dieline_.entities.size()), transformed(found.curve, X),
                                   *process, layer, std::move(found.origin)});
    }
  }

  void insert(const DxfRecord& record, const DxfFields& fields, const Eigen::Affine2d& X,
              const std::string& layer, int depth) {
    const std::string_view name = fields.text(2, "");
    const auto block = file_.blocks.find(lowered(name));
    if (block == file_.blocks.end()) {
      faults_.add(record.line(), fmt::format("INSERT of block {}, which is not defined", inQuotes(name)));
      return;
    }
    if (depth >= kDeepestNesting) {
      faults_.fatal(record.line(),
                    fmt::format("INSERT of block {} is nested deeper than {}: does it hold itself?",
                                inQuotes(name), kDeepestNesting));
    }
    const Eigen::Vector2d scale(fields.number(41, 1.0), fields.number(42, 1.0));
    if (scale.x() == 0 || scale.y() == 0) {
      faults_.add(record.line(), "INSERT with scale 0");
      return;
    }
    const int columns = std::max(1, fields.integer(70, 1));
    const int rows = std::max(1, fields.integer(71, 1));
    const Eigen::Vector2d pitch(fields.number(44, 0.0), fields.number(45, 0.0));
    Eigen::Affine2d placed = X * Eigen::Scaling(extrusionSign(record, faults_), 1.0);
    placed.translate(Eigen::Vector2d(fields.number(10), fields.number(20)));
    placed.rotate(fields.number(50, 0.0) * std::numbers::pi / 180);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        // Counted here too: an array of an empty block unfolds to nothing, but takes its time.
        if (++steps_ > kMostEntities)
          faults_.fatal(record.line(), fmt::format("more than {} entities", kMostEntities));
        Eigen::Affine2d copy = placed;
        copy.translate(Eigen::Vector2d(column * pitch.x(), row * pitch.y()));
        copy.scale(scale);
        copy.translate(Eigen::Vector2d(-block->second.base_x, -block->second.base_y));
        unfold(block->second.records, copy, layer, depth + 1);
      }
    }
  }

  const DxfFile& file_;
  const LayerProfile& profile_;
  FaultList& faults_;
  Dieline& dieline_;
  std::size_t steps_{};
};

}  // namespace

Dieline readDxf(std::string text, const LayerProfile& profile, FaultList& faults) {
  DxfFile file;
  parseDxf(std::move(text), file, faults);
  Dieline dieline;
  dieline.path = faults.path();
  Eigen::Affine2d X = Eigen::Affine2d::Identity();
  X.scale(unitOf(file, faults));
  Unfolder(file, profile, faults, dieline).unfold(file.entities, X, "", 0);
  faults.throwIfAny();
  return dieline;
}

}  // namespace kerfbench::dieline
