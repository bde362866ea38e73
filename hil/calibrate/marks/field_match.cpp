// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/calibrate/marks/field_marks.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kMostForeign = 0.1;    // Largest share of foreign marks of this job's sheet.
constexpr double kMostOtherwise = 0.1;  // Largest share of marks that are turned otherwise than most.
constexpr std::size_t kNamed = 12;      // Most marks that one sentence names.

std::string listed(const std::vector<int>& numbers) {
  const std::size_t shown = std::min(numbers.size(), kNamed);
  std::string text = fmt::format(
      "{}", fmt::join(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < numbers.size()) text += fmt::format(" and {} more", numbers.size() - shown);
  return text;
}

std::string marks(std::size_t count) { return count == 1 ? "1 mark" : fmt::format("{} marks", count); }

/// How most marks lie; as drawn where there is none.
MarkTurn mostCommon(const std::vector<FieldMark>& found) {
  MarkTurn most;
  std::ptrdiff_t best = 0;
  for (const MarkTurn& turn : markTurns()) {
    const auto count = std::ranges::count(found, turn, &FieldMark::turn);
    if (count <= best) continue;
    best = count;
    most = turn;
  }
  return most;
}

/// Where the head sends x and y, and what that comes from.
std::string layoutWords(const MarkTurn& turn) {
  // First x -> -x, then quarters to the left.
  static constexpr std::array<const char*, 8> kWords{
      "",
      "the field is turned by 90 degrees: x and y are swapped, and x runs backwards",
      "the field is turned by 180 degrees: x and y both run backwards",
      "the field is turned by 270 degrees: x and y are swapped, and y runs backwards",
      "the field is mirrored: x runs backwards",
      "the field is mirrored at a diagonal: x and y are swapped, and both run backwards",
      "the field is mirrored: y runs backwards",
      "the field is mirrored at a diagonal: x and y are swapped"};
  return kWords.at(static_cast<std::size_t>(turn.quarters + (turn.mirrored ? 4 : 0)));
}

void sortOut(const MarkJob& job, const FieldPictures& pictures, MarkedField& field) {
  std::map<int, std::vector<const FieldMark*>> found;
  for (const FieldMark& mark : pictures.marks) found[mark.number].push_back(&mark);
  std::set<int> wanted;
  for (const WantedMark& mark : job.marks) {
    wanted.insert(mark.number);
    const auto cut = found.find(mark.number);
    if (cut == found.end()) {
      field.missing.push_back(mark.number);
    } else if (cut->second.size() > 1) {
      field.doubled.push_back(mark.number);
    } else {
      field.points.push_back({mark, *cut->second.front()});
    }
  }
  for (const auto& [number, some] : found) {
    if (!wanted.contains(number)) field.foreign.push_back(number);
  }
  std::ranges::sort(field.missing);
  std::ranges::sort(field.doubled);
  std::ranges::sort(field.points, {}, [](const MarkPoint& point) { return point.wanted.number; });
}

void remark(const FieldPictures& pictures, MarkedField& field) {
  const auto say = [&](const std::vector<int>& numbers, const char* what) {
    if (!numbers.empty())
      field.remarks.push_back(fmt::format("{} {}: {}", marks(numbers.size()), what, listed(numbers)));
  };
  say(field.missing, "not found");
  say(field.doubled, "found more than once, not used");
  say(field.foreign, "found that the job has not");
  for (const DamagedMark& mark : pictures.damaged)
    field.remarks.push_back(
        fmt::format("the mark at ({:.2f}, {:.2f}) mm {}", mark.p_S_mm.x(), mark.p_S_mm.y(), mark.reason));
  if (pictures.strays > 0) field.remarks.push_back(fmt::format("{} cuts belong to no mark", pictures.strays));
  if (const std::string words = layoutWords(field.layout); !words.empty()) field.remarks.push_back(words);
}

void judge(const MarkJob& job, const FieldPictures& pictures, double least_share, MarkedField& field) {
  field.problems = pictures.problems;
  const auto found = static_cast<double>(pictures.marks.size());
  if (static_cast<double>(field.foreign.size()) > kMostForeign * found) {
    field.problems.push_back(
        fmt::format("{} of {} marks found are none of the job's: another job's sheet, or two jobs on one",
                    field.foreign.size(), pictures.marks.size()));
  }
  if (2 * field.doubled.size() > field.points.size() + field.doubled.size())
    field.problems.push_back(
        fmt::format("{} are there more than once: two sheets are mixed, or the job was cut twice",
                    marks(field.doubled.size())));
  const auto otherwise =
      std::ranges::count_if(pictures.marks, [&](const FieldMark& mark) { return mark.turn != field.layout; });
  if (static_cast<double>(otherwise) > kMostOtherwise * found)
    field.problems.push_back(fmt::format("{} of {} marks lie otherwise than the others: two sheets are mixed",
                                         otherwise, pictures.marks.size()));
  if (static_cast<double>(field.points.size()) < least_share * static_cast<double>(job.marks.size()))
    field.problems.push_back(
        fmt::format("only {} of {} marks can be used", field.points.size(), job.marks.size()));
}

}  // namespace

MarkedField matchField(const MarkJob& job, const FieldPictures& pictures, double least_share) {
  MarkedField field;
  field.layout = mostCommon(pictures.marks);
  sortOut(job, pictures, field);
  remark(pictures, field);
  judge(job, pictures, least_share, field);
  return field;
}

}  // namespace kerfbench::calibrate
