// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/dxf_layers.h"

#include <cstdlib>

#include <fmt/format.h>

#include "hil/dieline/text.h"

namespace kerfbench::dieline {
namespace {

constexpr int kByLayer = 256;
constexpr int kByBlock = 0;

std::string trueColour(std::string_view text) {
  const int rgb = parsedNumber<int>(text).value_or(0) & 0xffffff;
  return fmt::format("#{:06x}", static_cast<unsigned>(rgb));
}

std::string colourOf(int number) { return normalColour(fmt::format("{}", std::abs(number))).value_or("7"); }

DxfLayer readLayer(const DxfRecord& record) {
  DxfLayer layer;
  constexpr int kFrozen = 1;
  std::string_view true_colour;
  for (const DxfTag& tag : record.tags) {
    const int number = parsedNumber<int>(tag.text).value_or(0);
    switch (tag.code) {
      case 70:
        layer.is_frozen = (number & kFrozen) != 0;
        break;
      case 62:
        layer.is_off = number < 0;
        layer.style.colour = colourOf(number);
        break;
      case 290:
        layer.is_plotted = number != 0;
        break;
      case 420:
        true_colour = tag.text;
        break;
      case 6:
        layer.style.linetype = normalLinetype(tag.text);
        break;
      default:
        break;
    }
  }
  if (!true_colour.empty()) layer.style.colour = trueColour(true_colour);
  return layer;
}

std::string_view textOf(const DxfRecord& record, int code) {
  for (const DxfTag& tag : record.tags) {
    if (tag.code == code) return tag.text;
  }
  return {};
}

}  // namespace

DxfLooks::DxfLooks(const DxfFile& file, FaultList& faults) {
  for (const DxfRecord& record : file.tables) {
    if (record.type() != "LAYER") continue;
    const std::string_view name = textOf(record, 2);
    if (name.empty()) faults.add(record.line(), "LAYER lacks group 2");
    layers_.emplace(lowered(name), readLayer(record));
  }
  for (const DxfRecord& record : file.objects) {
    if (record.type() == "DICTIONARY" || record.type() == "SPATIAL_FILTER")
      objects_.emplace(textOf(record, 5), &record);
  }
}

const DxfLayer& DxfLooks::layer(std::string_view name) const {
  const auto found = layers_.find(lowered(name));
  return found == layers_.end() ? unknown_ : found->second;
}

DxfLook DxfLooks::lookOf(const DxfRecord& record, const DxfInherited& inherited) const {
  DxfLook look{"0", {}, false, false};
  int colour = kByLayer;
  std::string_view true_colour;
  std::string_view linetype = "BYLAYER";
  for (const DxfTag& tag : record.tags) {
    switch (tag.code) {
      case 8:
        look.layer = tag.text;
        break;
      case 6:
        linetype = tag.text;
        break;
      case 62:
        colour = parsedNumber<int>(tag.text).value_or(kByLayer);
        break;
      case 420:
        true_colour = tag.text;
        break;
      case 60:
        look.is_hidden = parsedNumber<int>(tag.text) == 1;
        break;
      case 67:
        look.is_on_paper = parsedNumber<int>(tag.text) == 1;
        break;
      default:
        break;
    }
  }
  if (look.layer == "0" && !inherited.layer.empty()) look.layer = inherited.layer;
  const LineStyle& of_layer = layer(look.layer).style;
  if (!true_colour.empty())
    look.style.colour = trueColour(true_colour);
  else if (colour == kByBlock)
    look.style.colour = inherited.style.colour;
  else
    look.style.colour = colour == kByLayer ? of_layer.colour : colourOf(colour);
  look.style.linetype = normalLinetype(linetype);
  if (look.style.linetype == "bylayer") look.style.linetype = of_layer.linetype;
  if (look.style.linetype == "byblock") look.style.linetype = inherited.style.linetype;
  return look;
}

const DxfRecord* DxfLooks::entryOf(std::string_view dictionary, std::string_view name) const {
  const auto found = objects_.find(dictionary);
  if (found == objects_.end()) return nullptr;
  bool is_next = false;
  for (const DxfTag& tag : found->second->tags) {
    if (tag.code == 3) is_next = tag.text == name;
    if (!is_next || (tag.code != 350 && tag.code != 360)) continue;
    const auto entry = objects_.find(tag.text);
    return entry == objects_.end() ? nullptr : entry->second;
  }
  return nullptr;
}

bool DxfLooks::isClipped(const DxfRecord& insert) const {
  constexpr int kControl = 102;
  bool in_dictionary = false;
  for (const DxfTag& tag : insert.tags) {
    if (tag.code == kControl) in_dictionary = tag.text == "{ACAD_XDICTIONARY";
    if (!in_dictionary || tag.code != 360) continue;
    const DxfRecord* filters = entryOf(tag.text, "ACAD_FILTER");
    if (filters == nullptr) return false;
    const DxfRecord* clip = entryOf(textOf(*filters, 5), "SPATIAL");
    return clip != nullptr && clip->type() == "SPATIAL_FILTER" &&
           parsedNumber<int>(textOf(*clip, 71)).value_or(1) != 0;
  }
  return false;
}

}  // namespace kerfbench::dieline
