// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/remarks.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {

/// Splits a sentence of NoteList: "text: 1 ignored: no line to cut (the first at line 12)".
Remark remarkFrom(const std::string& note) {
  constexpr std::string_view kPlace = " (the first at line ";
  const std::size_t at = note.rfind(kPlace);
  int line = 0;
  if (at == std::string::npos) return {0, false, note};
  const char* const begin = note.data() + at + kPlace.size();
  if (std::from_chars(begin, note.data() + note.size(), line).ec != std::errc()) return {0, false, note};
  return {line, true, note.substr(0, at)};
}

std::string sizeWords(const Dieline& dieline) {
  const Eigen::AlignedBox2d box = dieline.bounds();
  return box.isEmpty()
             ? std::string()
             : fmt::format(", which makes the drawing {:.1f} x {:.1f} mm", box.sizes().x(), box.sizes().y());
}

}  // namespace

std::string nameOfUnit(double unit_mm) {
  for (const char* name : {"mm", "cm", "in", "pt", "px"}) {
    if (std::abs(unit_mm - millimetresOf(*drawingUnitFromName(name))) < 1e-9 * unit_mm) return name;
  }
  return {};
}

std::vector<Remark> remarksOf(const Dieline& dieline) {
  std::vector<Remark> remarks;
  if (dieline.unsaid_unit) {
    const double unit_mm = dieline.unsaid_unit->taken_mm;
    const std::string name = nameOfUnit(unit_mm);
    remarks.push_back(
        {dieline.unsaid_unit->line, true,
         fmt::format("the file does not say how long one unit is; it is taken as 1 {}{}{}", name,
                     name == "mm" ? "" : fmt::format(" ({:.4g} mm)", unit_mm), sizeWords(dieline))});
  }
  for (const std::string& note : dieline.notes) remarks.push_back(remarkFrom(note));
  return remarks;
}

}  // namespace kerfbench::dieline
