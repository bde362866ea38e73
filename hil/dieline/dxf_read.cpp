// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <fmt/format.h>

#include "hil/dieline/dxf_bombs.h"
#include "hil/dieline/dxf_entities.h"
#include "hil/dieline/dxf_layers.h"
#include "hil/dieline/dxf_tags.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/notes.h"
#include "hil/dieline/readers.h"
#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

/// Millimetres per drawing unit. $INSUNITS decides; a file without it (R12) that says $MEASUREMENT = 0 is in
/// inches; all else is unitless, which means mm in this trade. Where both say something and do not agree,
/// only the designer knows.
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
  const auto measurement = variable("$MEASUREMENT");
  if (!units) return measurement == 0 ? 25.4 : 1.0;
  switch (*units) {
    case 0:
      if (measurement != 0) return 1.0;
      faults.add(file.header.find("$INSUNITS")->second.line,
                 "$INSUNITS is 0 (no unit) and $MEASUREMENT 0 (English): say what a drawing unit is with "
                 "dieline: {unit: mm} or {unit: in}");
      return 1.0;
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
          fmt::format(
              "$INSUNITS {} is not supported; inch (1), mm (4), cm (5), m (6) and none (0) are; or say "
              "what a drawing unit is with dieline: {{unit: mm}} or another of cm, in, pt",
              *units));
      return 1.0;
  }
}

/// The line at which a file says that its unit is none, 0 where it says nothing at all; nothing where it says
/// one.
std::optional<int> lineOfUnsaidUnit(const DxfFile& file) {
  const auto number = [&](std::string_view name) -> std::optional<int> {
    const auto it = file.header.find(name);
    return it == file.header.end() ? std::nullopt : parsedNumber<int>(it->second.text);
  };
  const auto units = number("$INSUNITS");
  if (units) return *units == 0 ? std::optional(file.header.find("$INSUNITS")->second.line) : std::nullopt;
  return number("$MEASUREMENT") == 0 ? std::nullopt : std::optional(0);
}

/// Things beside the lines of a drawing: text, measures, fills, pictures and construction lines.
bool isBesideTheLines(std::string_view type) {
  constexpr std::array kTypes{"TEXT",        "MTEXT",       "RTEXT",         "ARCALIGNEDTEXT",
                              "POINT",       "DIMENSION",   "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION",
                              "LEADER",      "MULTILEADER", "MLEADER",       "TOLERANCE",
                              "HATCH",       "SOLID",       "IMAGE",         "WIPEOUT",
                              "OLEFRAME",    "OLE2FRAME",   "PDFUNDERLAY",   "DWFUNDERLAY",
                              "DGNUNDERLAY", "ACAD_TABLE",  "XLINE",         "RAY"};
  return std::any_of(kTypes.begin(), kTypes.end(), [&](std::string_view known) { return type == known; });
}

/// Parts of the entity before them, and the window of a layout, are no part of the dieline.
bool isPart(std::string_view type) {
  return type == "VERTEX" || type == "SEQEND" || type == "ATTRIB" || type == "ATTDEF" || type == "VIEWPORT";
}

/// Adds the handles of the frames that MTEXTs among the records have: lines of their own, which the text
/// names in its extended data.
void addFrames(const std::vector<DxfRecord>& records, std::set<std::string, std::less<>>& handles) {
  for (const DxfRecord& record : records) {
    if (record.type() != "MTEXT") continue;
    bool is_border = false;
    for (const DxfTag& tag : record.tags) {
      if (tag.code == 1000 && tag.text == "ACAD_MTEXT_TEXT_BORDERS_BEGIN") is_border = true;
      if (tag.code == 1000 && tag.text == "ACAD_MTEXT_TEXT_BORDERS_END") is_border = false;
      if (is_border && tag.code == 1005) handles.insert(lowered(tag.text));
    }
  }
}

class Unfolder {
 public:
  Unfolder(const DxfFile& file, const DrawingOptions& options, FaultList& faults, Dieline& dieline,
           base::ShareProgress& progress)
      : file_(file),
        profile_(options.layers),
        faults_(faults),
        dieline_(dieline),
        progress_(progress),
        looks_(file, faults),
        census_(options.layers) {}

  void read(const Eigen::Affine2d& X) {
    refuseBombs(file_, faults_);
    addFrames(file_.entities, frames_);
    for (const auto& [name, block] : file_.blocks) addFrames(block.records, frames_);
    unfold(file_.entities, X, {});
    census_.refuse(faults_);
    dieline_.notes = notes_.sentences();
  }

 private:
  void unfold(const std::vector<DxfRecord>& records, const Eigen::Affine2d& X,
              const DxfInherited& inherited) {
    for (std::size_t i = 0; i < records.size(); ++i) {
      const DxfRecord& record = records[i];
      const std::string_view type = record.type();
      progress_.done(file_.text.size() + static_cast<std::size_t>(type.data() - file_.text.data()));
      if (isPart(type)) continue;
      const DxfLook look = looks_.lookOf(record, inherited);
      if (look.is_on_paper || !isShown(record, look)) continue;
      const bool is_frame =
          !frames_.empty() && frames_.contains(lowered(DxfFields(record, faults_).text(5, "")));
      if (is_frame || isBesideTheLines(type)) {
        notes_.add(record.line(), is_frame ? "frame of a text" : type, "ignored: no line to cut");
        continue;
      }
      try {
        if (type == "INSERT") {
          insert(record, X, look);
        } else {
          curves(records, i, X, look);
        }
      } catch (const DxfUnsupported& unsupported) {
        if (processFor(profile_, look.layer) != Process::kIgnore)
          faults_.add(record.line(), fmt::format("{} (layer {})", unsupported.what(), inQuotes(look.layer)));
      }
    }
  }

  /// What an INSERT holds on layers of its own is shown although the INSERT's layer is off.
  bool isShown(const DxfRecord& record, const DxfLook& look) {
    const std::string_view type = record.type();
    const auto leftOut = [&](std::string_view why) {
      if (processFor(profile_, look.layer) != Process::kIgnore || type == "INSERT")
        notes_.add(record.line(), fmt::format("{} {}", type, why), "left out: not shown in the drawing");
      return false;
    };
    if (look.is_hidden) return leftOut("that is invisible");
    const DxfLayer& layer = looks_.layer(look.layer);
    if (layer.is_frozen) return leftOut(fmt::format("on the frozen layer {}", inQuotes(look.layer)));
    if (type == "INSERT") return true;
    if (layer.is_off) return leftOut(fmt::format("on layer {}, which is switched off", inQuotes(look.layer)));
    if (layer.is_plotted || isBesideTheLines(type)) return true;
    const std::string not_plotted =
        fmt::format("on layer {}, which is not to be plotted", inQuotes(look.layer));
    if (processFor(profile_, look.layer) == Process::kIgnore) return true;
    if (!hasRule(profile_, look.layer)) return leftOut(not_plotted);
    if (profile_.name != "default") {
      notes_.add(record.line(), fmt::format("{} {}", type, not_plotted), "read, for a rule names the layer");
      return true;
    }
    faults_.add(record.line(), fmt::format("{} {}; say layers: {{{}: cut}} or whatever it is for, or {{{}: "
                                           "ignore}}",
                                           type, not_plotted, look.layer, look.layer));
    return false;
  }

  void curves(const std::vector<DxfRecord>& records, std::size_t index, const Eigen::Affine2d& X,
              const DxfLook& look) {
    const DxfRecord& record = records[index];
    std::vector<DxfCurve> found = dxfCurves(records, index, faults_, notes_);
    for (DxfCurve& one : found) one.curve = transformed(one.curve, X);
    std::erase_if(found, [&](const DxfCurve& one) {
      const auto* line = std::get_if<LineCurve>(&one.curve);
      if (line == nullptr || (line->end_mm - line->start_mm).norm() > kNothing_mm) return false;
      notes_.add(record.line(), fmt::format("{} of length 0", record.type()), "left out: nothing to cut");
      return true;
    });
    if (found.empty()) return;
    const auto process = census_.processOf(look.layer, look.style, record.line(), record.type(), faults_);
    if (dieline_.entities.size() + found.size() > kMostEntities)
      faults_.fatal(record.line(), fmt::format("more than {} entities", kMostEntities));
    if (!process) return;
    for (DxfCurve& one : found) {
      dieline_.entities.push_back({static_cast<int>(dieline_.entities.size()), std::move(one.curve), *process,
                                   look.layer, std::move(one.origin)});
    }
  }

  void insert(const DxfRecord& record, const Eigen::Affine2d& X, const DxfLook& look) {
    const DxfFields fields(record, faults_);
    const std::string_view name = fields.text(2, "");
    const auto block = file_.blocks.find(lowered(name));
    if (block == file_.blocks.end()) {
      faults_.add(record.line(), fmt::format("INSERT of block {}, which is not defined", inQuotes(name)));
      return;
    }
    if (looks_.isClipped(record)) {
      faults_.add(record.line(),
                  fmt::format("INSERT of block {} is clipped (XCLIP), which is not read: explode it and trim "
                              "its lines, or delete the clip",
                              inQuotes(name)));
      return;
    }
    const Eigen::Vector2d scale(fields.number(41, 1.0), fields.number(42, 1.0));
    if (scale.x() == 0 || scale.y() == 0) {
      faults_.add(record.line(), "INSERT with scale 0");
      return;
    }
    const DxfArray array = arrayOf(record, faults_);
    const Eigen::Vector2d pitch(fields.number(44, 0.0), fields.number(45, 0.0));
    Eigen::Affine2d placed = X * Eigen::Scaling(extrusionSign(record, faults_), 1.0);
    placed.translate(Eigen::Vector2d(fields.number(10), fields.number(20)));
    placed.rotate(fields.number(50, 0.0) * std::numbers::pi / 180);
    const DxfInherited inherited{look.layer, look.style};
    for (int row = 0; row < array.rows; ++row) {
      for (int column = 0; column < array.columns; ++column) {
        Eigen::Affine2d copy = placed;
        copy.translate(Eigen::Vector2d(column * pitch.x(), row * pitch.y()));
        copy.scale(scale);
        copy.translate(Eigen::Vector2d(-block->second.base_x, -block->second.base_y));
        unfold(block->second.records, copy, inherited);
      }
    }
  }

  const DxfFile& file_;
  std::set<std::string, std::less<>> frames_;  ///< Handles of frames of texts, in lower case.
  const LayerProfile& profile_;
  FaultList& faults_;
  Dieline& dieline_;
  base::ShareProgress& progress_;
  DxfLooks looks_;
  LayerCensus census_;
  NoteList notes_;
};

}  // namespace

Dieline readDxf(std::string text, const DrawingOptions& options, FaultList& faults) {
  DxfFile file;
  // Two passes: bytes become groups, groups become curves.
  base::ShareProgress progress = readingProgress(options, faults, 2 * text.size());
  parseDxf(std::move(text), file, faults, progress);
  Dieline dieline;
  dieline.path = faults.path();
  Eigen::Affine2d X = Eigen::Affine2d::Identity();
  const double unit_mm = options.unit ? millimetresOf(*options.unit) : unitOf(file, faults);
  if (const auto line = lineOfUnsaidUnit(file)) dieline.unsaid_unit = UnsaidUnit{*line, unit_mm};
  X.scale(unit_mm);
  Unfolder(file, options, faults, dieline, progress).read(X);
  faults.throwIfAny();
  return dieline;
}

}  // namespace kerfbench::dieline
