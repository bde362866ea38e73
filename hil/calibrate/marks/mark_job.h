// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/dieline/process.h"
#include "twin/base/print_layout.h"

namespace kerfbench::calibrate {

/// Wanted centre of a mark.
struct WantedMark {
  int number{};
  Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};  ///< Place in the machine's frame, under the head.
};

/// Something wrong with a job.
struct MarkJobFault {
  std::string key;          ///< Key as in the file: "date", "size_mm", …
  std::ptrdiff_t mark{-1};  ///< Index into MarkJob::marks; -1: of the job as a whole.
  std::string message;
};

/// Marks to be cut into one sheet, and what is needed to make sense of its pictures later.
struct MarkJob {
  std::string name;     ///< Name of the job, for people.
  std::string machine;  ///< Name of the machine.
  std::string date;     ///< ISO 8601 day on which the job was planned.
  double size_mm{};     ///< Size of a mark; 4.5 … 100.
  /// Place of the sheet under the head while it is cut: p_S = p_W + p_SW. Axes of W and S are parallel.
  Eigen::Vector2d p_SW_mm{Eigen::Vector2d::Zero()};
  std::vector<RegistrationMark> print;  ///< The printed marks of the sheet, two at least: they hold frame S.
  std::vector<WantedMark> marks;        ///< Marks in order of cutting; numbers 1 … kMarkNumbers, each once.

  /// Everything that is wrong: values out of range, numbers twice, marks nearer to each other than kMarkPitch
  /// sizes, marks on top of print. Empty when nothing is.
  [[nodiscard]] std::vector<MarkJobFault> faults() const;
  [[nodiscard]] Eigen::Vector2d wanted_S_mm(const WantedMark& mark) const { return mark.p_W_mm + p_SW_mm; }
  /// Cuts of the job in S, mark by mark in order: arms, then ticks; layer "cut".
  [[nodiscard]] dieline::Dieline dieline() const;
};

/// Distance of two marks as far as room is concerned: along x or along y, whichever is more.
double marksApart_mm(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm);

/// n x n places over the field, rim included, in rows that go to and fro. @throws std::invalid_argument for
/// n < 2 or an empty field.
std::vector<Eigen::Vector2d> gridPlaces(const Eigen::AlignedBox2d& field_mm, int n);

struct RandomPlaces {
  int count{};
  double apart_mm{};                   ///< Least distance from each other; see marksApart_mm().
  std::vector<Eigen::Vector2d> known;  ///< Places that were marked before: none of the new is nearer
  double from_known_mm{};              ///< than this to one of them.
  /// A tenth of the places, rounded up, is of these if so many are free: middles of cells, say.
  std::vector<Eigen::Vector2d> favoured;
  std::uint64_t seed{1};
};
/// Places sampled evenly over the field, a tenth of them, rounded up, on its rim, in rows that go to and fro.
/// @throws std::invalid_argument if there is no room for that many.
std::vector<Eigen::Vector2d> randomPlaces(const Eigen::AlignedBox2d& field_mm, const RandomPlaces& request);

/// Numbers places from `first_number` on. @throws std::out_of_range beyond kMarkNumbers.
std::vector<WantedMark> numbered(const std::vector<Eigen::Vector2d>& places_mm, int first_number);

/// The largest size of marks, in halves of a millimetre, that fits places `apart_mm` apart, but not more than
/// the kerf's width asks for (24 kerfs, kWidestKerf at least). @throws std::invalid_argument if none does.
double markSizeFor(double apart_mm, double kerf_width_mm);

}  // namespace kerfbench::calibrate
