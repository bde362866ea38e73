// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/read.h"

#include <map>
#include <numbers>

#include <fmt/format.h>

#include "hil/base/input_file.h"
#include "hil/dieline/curve_math.h"
#include "hil/dieline/file_format.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/ignored_layers.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/repeats.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

std::string contentsOf(const std::filesystem::path& path, FaultList& faults) {
  base::InputContent content = base::readInput(path, kLargestFile);
  if (!content.bytes) faults.fatal(0, content.refusal);
  if (content.bytes->empty()) faults.fatal(0, "is empty");
  return *std::move(content.bytes);
}

/// Scales, turns and shifts a drawing as it is told; a drawing without any of it keeps its very numbers.
void place(Dieline& dieline, const DrawingOptions& options) {
  if (options.scale == 1.0 && options.turn_deg == 0.0 && options.shift_mm.isZero(0.0)) return;
  Eigen::Affine2d X(Eigen::Translation2d(options.shift_mm));
  X.rotate(options.turn_deg * std::numbers::pi / 180).scale(options.scale);
  for (Entity& entity : dieline.entities) entity.curve = transformed(entity.curve, X);
}

/// Nested scales can leave the range of a sheet although each number of the file is sound.
void checkRange(const Dieline& dieline, FaultList& faults) {
  constexpr double kFarthest_mm = 1e6;
  for (const Entity& entity : dieline.entities) {
    const Eigen::AlignedBox2d box = boundsOf(entity.curve);
    const double farthest_mm = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    const bool is_number = box.min().allFinite() && box.max().allFinite();
    if (!is_number || !(farthest_mm <= kFarthest_mm)) {
      faults.add(0, fmt::format("E{} ({}) reaches {} mm from the origin; wrong units or scale?", entity.id,
                                entity.origin, farthest_mm));
    }
  }
}

}  // namespace

double millimetresOf(DrawingUnit unit) {
  switch (unit) {
    case DrawingUnit::kMillimetre:
      return 1.0;
    case DrawingUnit::kCentimetre:
      return 10.0;
    case DrawingUnit::kInch:
      return 25.4;
    case DrawingUnit::kPoint:
      return 25.4 / 72;
    case DrawingUnit::kPixel:
      return 25.4 / 96;
  }
  return 1.0;
}

std::optional<DrawingUnit> drawingUnitFromName(std::string_view name) {
  static const std::map<std::string, DrawingUnit, std::less<>> kUnits{{"mm", DrawingUnit::kMillimetre},
                                                                      {"cm", DrawingUnit::kCentimetre},
                                                                      {"in", DrawingUnit::kInch},
                                                                      {"pt", DrawingUnit::kPoint},
                                                                      {"px", DrawingUnit::kPixel}};
  const auto found = kUnits.find(lowered(name));
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

Dieline readDieline(const std::filesystem::path& path, const LayerProfile& profile) {
  DrawingOptions options;
  options.layers = profile;
  return readDieline(path, options);
}

Dieline readDieline(const std::filesystem::path& path, const DrawingOptions& options) {
  FaultList faults(path.string());
  const std::string extension = lowered(path.extension().string());
  Dieline dieline;
  if (options.page && fileFormatOf(path) != FileFormat::kPdf)
    faults.fatal(0, "only a PDF has pages: leave 'page' out");
  if (extension == ".dxf") {
    dieline = readDxf(contentsOf(path, faults), options, faults);
  } else if (extension == ".svg") {
    dieline = readSvg(contentsOf(path, faults), options, faults);
  } else if (const auto format = fileFormatOf(path)) {
    dieline = (*format == FileFormat::kCf2 ? readCf2 : readPdf)(contentsOf(path, faults), options, faults);
  } else {
    faults.fatal(
        0, fmt::format("extension {} is not supported; .dxf, .svg, .pdf and .cf2 are", inQuotes(extension)));
  }
  noteIgnoredLayers(dieline);
  place(dieline, options);
  checkRange(dieline, faults);
  faults.throwIfAny();
  if (options.once) leaveOutRepeats(dieline, faults);
  faults.throwIfAny();
  return dieline;
}

}  // namespace kerfbench::dieline
