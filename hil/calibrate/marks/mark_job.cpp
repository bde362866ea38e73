// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_job.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/calibrate/files/day.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/dieline/geometry.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kFarthest_mm = 1e4;
constexpr double kRounding_mm = 1e-6;
/// Least size; of smaller marks a dieline's checker takes the ticks for one broken line.
constexpr double kLeastSize_mm = 4.5;
constexpr double kMostSize_mm = 100.0;
constexpr double kSizeStep_mm = 0.5;
constexpr double kKerfs = 24.0;  // Size of a mark in kerf widths, where there is room.

void checkField(const AlignedBox2d& field_mm) {
  if (field_mm.isEmpty() || !field_mm.sizes().allFinite() || !(field_mm.sizes().minCoeff() > 0.0))
    throw std::invalid_argument("marks: the field is empty");
}

/// Rows of about even height from below, the first to the right, the next to the left.
void sortInRows(std::vector<Vector2d>& places_mm, const AlignedBox2d& field_mm) {
  const auto rows = std::max(1.0, std::floor(std::sqrt(0.5 * static_cast<double>(places_mm.size()))));
  const auto rowOf = [&](const Vector2d& p) {
    const double row = std::floor(rows * (p.y() - field_mm.min().y()) / field_mm.sizes().y());
    return static_cast<int>(std::clamp(row, 0.0, rows - 1.0));
  };
  std::ranges::sort(places_mm, [&](const Vector2d& a, const Vector2d& b) {
    const int row = rowOf(a);
    if (row != rowOf(b)) return row < rowOf(b);
    return row % 2 == 0 ? a.x() < b.x() : a.x() > b.x();
  });
}

constexpr std::size_t kEach = 10;  // One of so many places is favoured, one on the rim.

/// The nth draw over the field, or over its rim.
Vector2d draw(const CounterRandom& random, std::uint64_t n, bool on_rim, const AlignedBox2d& field_mm) {
  Vector2d share(random.uniform(3 * n), random.uniform(3 * n + 1));
  if (on_rim) {
    const auto side = static_cast<int>(4.0 * random.uniform(3 * n + 2));
    share[side % 2] = side < 2 ? 0.0 : 1.0;
  }
  return field_mm.min() + share.cwiseProduct(field_mm.sizes());
}

/// Takes one out; share in [0, 1).
Vector2d taken(std::vector<Vector2d>& from_mm, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(from_mm.size()));
  std::swap(from_mm[at], from_mm.back());
  const Vector2d p_mm = from_mm.back();
  from_mm.pop_back();
  return p_mm;
}

bool isFree(const Vector2d& p_mm, const std::vector<Vector2d>& places_mm, double apart_mm) {
  return std::ranges::none_of(places_mm,
                              [&](const Vector2d& other) { return marksApart_mm(other, p_mm) < apart_mm; });
}

void faultsOfValues(const MarkJob& job, std::vector<MarkJobFault>& found) {
  const auto require = [&found](bool fine, const char* key, std::ptrdiff_t mark, const std::string& rule) {
    if (!fine) found.push_back({key, mark, rule});
  };
  const auto near = [](const Vector2d& p_mm) {
    return p_mm.allFinite() && p_mm.cwiseAbs().maxCoeff() <= kFarthest_mm;
  };
  require(!job.machine.empty(), "machine", -1, "is empty");
  require(dayNumber(job.date).has_value(), "date", -1, "is no day like 2026-11-21");
  require(job.size_mm >= kLeastSize_mm && job.size_mm <= kMostSize_mm, "size_mm", -1,
          fmt::format("must be {} … {}", kLeastSize_mm, kMostSize_mm));
  require(near(job.p_SW_mm), "p_SW_mm", -1, "lies too far away");
  require(job.print.size() >= 2, "print", -1, "must have two marks at least: they hold the sheet's frame");
  const bool several = !job.marks.empty() && job.marks.size() <= static_cast<std::size_t>(kMarkNumbers);
  require(several, "marks", -1, fmt::format("must be 1 … {}, are {}", kMarkNumbers, job.marks.size()));
  std::set<int> numbers;
  for (std::size_t i = 0; i < job.marks.size(); ++i) {
    const WantedMark& mark = job.marks[i];
    const auto at = static_cast<std::ptrdiff_t>(i);
    require(mark.number >= 0 && mark.number < kMarkNumbers, "number", at,
            fmt::format("must be 0 … {}, is {}", kMarkNumbers - 1, mark.number));
    require(numbers.insert(mark.number).second, "number", at, fmt::format("{} is there twice", mark.number));
    require(near(mark.p_W_mm), "p_W_mm", at, "lies too far away");
  }
}

void faultsOfRoom(const MarkJob& job, std::vector<MarkJobFault>& found) {
  const double least_mm = kMarkPitch * job.size_mm;
  for (std::size_t i = 0; i < job.marks.size(); ++i) {
    const WantedMark& mark = job.marks[i];
    const auto at = static_cast<std::ptrdiff_t>(i);
    for (std::size_t j = 0; j < i; ++j) {
      const double apart_mm = marksApart_mm(mark.p_W_mm, job.marks[j].p_W_mm);
      if (apart_mm >= least_mm - kRounding_mm) continue;
      found.push_back({"p_W_mm", at,
                       fmt::format("mark {} lies {:.3f} mm from mark {}, {:.3f} mm are needed", mark.number,
                                   apart_mm, job.marks[j].number, least_mm)});
    }
    for (const RegistrationMark& disc : job.print) {
      const double room_mm = 0.5 * (kMarkReach * job.size_mm + disc.diameter_mm);
      if ((job.wanted_S_mm(mark) - disc.p_SM_mm).cwiseAbs().maxCoeff() > room_mm) continue;
      found.push_back({"p_W_mm", at,
                       fmt::format("mark {} lies on the printed mark at ({:.2f}, {:.2f}) mm", mark.number,
                                   disc.p_SM_mm.x(), disc.p_SM_mm.y())});
    }
  }
}

}  // namespace

double marksApart_mm(const Vector2d& a_mm, const Vector2d& b_mm) {
  return (a_mm - b_mm).cwiseAbs().maxCoeff();
}

std::vector<MarkJobFault> MarkJob::faults() const {
  std::vector<MarkJobFault> found;
  faultsOfValues(*this, found);
  // Distances mean nothing between places that are not numbers.
  if (found.empty()) faultsOfRoom(*this, found);
  return found;
}

dieline::Dieline MarkJob::dieline() const {
  dieline::Dieline drawing;
  const auto add = [&](const WantedMark& mark, const MarkStroke& stroke) {
    const Vector2d centre_mm = wanted_S_mm(mark);
    drawing.entities.push_back({static_cast<int>(drawing.entities.size()),
                                dieline::LineCurve{centre_mm + stroke.from_mm, centre_mm + stroke.to_mm},
                                dieline::Process::kCut, "CUT", fmt::format("mark {}", mark.number)});
  };
  for (const WantedMark& mark : marks) {
    for (const MarkStroke& arm : markArms(size_mm)) add(mark, arm);
    for (const MarkStroke& tick : markTicks(mark.number, size_mm)) add(mark, tick);
  }
  return drawing;
}

std::vector<Vector2d> gridPlaces(const AlignedBox2d& field_mm, int n) {
  checkField(field_mm);
  if (n < 2) throw std::invalid_argument("marks: a grid has two places each way at least");
  std::vector<Vector2d> places_mm;
  for (int row = 0; row < n; ++row) {
    for (int i = 0; i < n; ++i) {
      const int column = row % 2 == 0 ? i : n - 1 - i;
      const Vector2d share = Vector2d(column, row) / (n - 1);
      places_mm.emplace_back(field_mm.min() + share.cwiseProduct(field_mm.sizes()));
    }
  }
  return places_mm;
}

std::vector<Vector2d> randomPlaces(const AlignedBox2d& field_mm, const RandomPlaces& request) {
  checkField(field_mm);
  constexpr std::uint64_t kStream = 0x6d61726b73ULL;
  constexpr std::uint64_t kTries = 500;  // Most tries for each place.
  const CounterRandom random(request.seed, kStream);
  std::vector<Vector2d> places_mm;
  std::vector<Vector2d> favoured_mm = request.favoured;
  const auto wanted = static_cast<std::size_t>(std::max(0, request.count));
  const std::size_t each = (wanted + kEach - 1) / kEach;
  std::size_t favoured = 0;
  for (std::uint64_t n = 0; places_mm.size() < wanted; ++n) {
    if (n >= kTries * wanted) {
      throw std::invalid_argument(fmt::format("marks: there is room for {} of {} places {:.2f} mm apart",
                                              places_mm.size(), wanted, request.apart_mm));
    }
    // First what has the least choice.
    const bool favour = favoured < each && !favoured_mm.empty();
    const bool on_rim = places_mm.size() < favoured + each;
    const Vector2d p_mm =
        favour ? taken(favoured_mm, random.uniform(3 * n)) : draw(random, n, on_rim, field_mm);
    if (!isFree(p_mm, places_mm, request.apart_mm) || !isFree(p_mm, request.known, request.from_known_mm))
      continue;
    places_mm.push_back(p_mm);
    if (favour) ++favoured;
  }
  sortInRows(places_mm, field_mm);
  return places_mm;
}

std::vector<WantedMark> numbered(const std::vector<Vector2d>& places_mm, int first_number) {
  if (first_number < 0 ||
      places_mm.size() > static_cast<std::size_t>(std::max(0, kMarkNumbers - first_number)))
    throw std::out_of_range(fmt::format("marks: numbers {} … {} are not all below {}", first_number,
                                        first_number + static_cast<int>(places_mm.size()) - 1, kMarkNumbers));
  std::vector<WantedMark> marks;
  int number = first_number;
  for (const Vector2d& p_mm : places_mm) marks.push_back({number++, p_mm});
  return marks;
}

double markSizeFor(double apart_mm, double kerf_width_mm) {
  if (!(kerf_width_mm > 0.0)) throw std::invalid_argument("marks: a kerf is wider than nothing");
  const double most_mm = std::min(apart_mm / kMarkPitch, kKerfs * kerf_width_mm);
  const double size_mm = kSizeStep_mm * std::floor(most_mm / kSizeStep_mm + 1e-9);
  if (!(size_mm * kWidestKerf >= kerf_width_mm) || !(size_mm >= kLeastSize_mm))
    throw std::invalid_argument(fmt::format(
        "marks: places {:.2f} mm apart are too near for a kerf of {:.2f} mm", apart_mm, kerf_width_mm));
  return size_mm;
}

}  // namespace kerfbench::calibrate
