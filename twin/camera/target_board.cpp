// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/target_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

constexpr double kReach = 4.5;  // Reach in sigmas; 4e-6 of a Gaussian lie beyond.

double upTo(double sigmas) { return 0.5 * std::erfc(-sigmas / std::numbers::sqrt2); }

/// Share that correlation adds to a bivariate Gaussian below (a, b), against upTo(a) * upTo(b): 1/(2 pi)
/// times the integral of exp(-(a² + b² - 2 a b sin t) / (2 cos² t)) for t from 0 to asin(correlation)
/// (Drezner and Wesolowsky 1990), by Gauss and Legendre with six points.
double addedByCorrelation(double a, double b, double correlation) {
  constexpr std::array<double, 3> kNode{0.2386191860831969, 0.6612093864662645, 0.9324695142031521};
  constexpr std::array<double, 3> kWeight{0.4679139345726910, 0.3607615730481386, 0.1713244923791704};
  const double half = 0.5 * std::asin(correlation);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double sine = std::sin(half * (1.0 + side * kNode[i]));
      sum += kWeight[i] * std::exp(-(a * a + b * b - 2.0 * a * b * sine) / (2.0 * (1.0 - sine * sine)));
    }
  }
  return half * sum / (2.0 * std::numbers::pi);
}

}  // namespace

std::string faultsOf(const TargetBoard& board) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "target: " : "; ") + std::string(rule);
  };
  const auto gray = [](double value) { return value >= 0.0 && value <= 255.0; };
  require(board.columns >= 2 && board.columns <= 200, "columns must be in [2, 200]");
  require(board.rows >= 2 && board.rows <= 200, "rows must be in [2, 200]");
  require(board.square_mm > 0.0 && board.square_mm <= 1e4, "square_mm must be in (0, 1e4]");
  require(board.margin_mm >= 0.0 && board.margin_mm <= 1e5, "margin_mm must be in [0, 1e5]");
  require(gray(board.white_gray) && gray(board.black_gray) && gray(board.around_gray),
          "white_gray, black_gray and around_gray must be in [0, 255]");
  if (board.markers.empty()) return faults;
  const bool cells_fine = board.marker_cells >= 1 && board.marker_cells <= 32;
  require(board.marker_mm > 0.0 && board.marker_mm < board.square_mm, "marker_mm must be in (0, square_mm)");
  require(cells_fine, "marker_cells must be in [1, 32]");
  const auto cells = static_cast<std::size_t>(board.marker_cells * board.marker_cells);
  for (const TargetMarker& marker : board.markers) {
    require(marker.column >= 0 && marker.column < board.columns && marker.row >= 0 && marker.row < board.rows,
            "a marker must lie in one of the squares");
    require(((marker.column + marker.row) % 2 == 0) != board.first_is_black,
            "a marker must lie in a white square");
    if (cells_fine)
      require(marker.white.size() == cells, "a marker must have marker_cells * marker_cells cells");
  }
  return faults;
}

void TargetPattern::Lines::finish() {
  std::sort(at_mm.begin(), at_mm.end());
  const double same_mm = 1e-9 * (at_mm.back() - at_mm.front());
  at_mm.erase(std::unique(at_mm.begin(), at_mm.end(), [&](double a, double b) { return b - a <= same_mm; }),
              at_mm.end());
  const std::size_t buckets = 4 * at_mm.size();
  bucket_mm = (at_mm.back() - at_mm.front()) / static_cast<double>(buckets);
  for (std::size_t b = 0; b < buckets; ++b) {
    const double begin_mm = at_mm.front() + bucket_mm * static_cast<double>(b);
    bucket.push_back(
        static_cast<std::size_t>(std::lower_bound(at_mm.begin(), at_mm.end(), begin_mm) - at_mm.begin()));
  }
}

std::size_t TargetPattern::Lines::below(double place_mm) const {
  const double along = (place_mm - at_mm.front()) / bucket_mm;
  if (!(along >= 0.0)) return 0;
  if (along >= static_cast<double>(bucket.size())) return at_mm.size();
  std::size_t line = bucket[static_cast<std::size_t>(along)];
  // A place on the border of two stretches may round into the later one.
  while (line > 0 && at_mm[line - 1] > place_mm) --line;
  while (line < at_mm.size() && at_mm[line] <= place_mm) ++line;
  return line;
}

/// The print, square by square.
class TargetPattern::Print {
 public:
  explicit Print(const TargetBoard& board)
      : board_(board), markers_(static_cast<std::size_t>(board.columns * board.rows), nullptr) {
    for (const TargetMarker& marker : board.markers)
      markers_[static_cast<std::size_t>(marker.row * board.columns + marker.column)] = &marker;
  }

  [[nodiscard]] double at(const Vector2d& p_B_mm) const {
    const Vector2d size_mm = board_.square_mm * Vector2d(board_.columns, board_.rows);
    const double outside_mm = (-p_B_mm).cwiseMax(p_B_mm - size_mm).maxCoeff();
    if (outside_mm > board_.margin_mm) return board_.around_gray;
    if (outside_mm > 0.0) return board_.white_gray;
    const int column = static_cast<int>(p_B_mm.x() / board_.square_mm);
    const int row = static_cast<int>(p_B_mm.y() / board_.square_mm);
    if (((column + row) % 2 == 0) == board_.first_is_black) return board_.black_gray;
    const TargetMarker* const marker = markers_[static_cast<std::size_t>(row * board_.columns + column)];
    if (marker == nullptr) return board_.white_gray;
    const double border_mm = 0.5 * (board_.square_mm - board_.marker_mm);
    const Vector2d in_cells =
        (p_B_mm - board_.square_mm * Vector2d(column, row) - Vector2d::Constant(border_mm)) *
        (board_.marker_cells / board_.marker_mm);
    if (in_cells.minCoeff() < 0.0 || in_cells.maxCoeff() >= board_.marker_cells) return board_.white_gray;
    const int cell = static_cast<int>(in_cells.y()) * board_.marker_cells + static_cast<int>(in_cells.x());
    return marker->white[static_cast<std::size_t>(cell)] != 0 ? board_.white_gray : board_.black_gray;
  }

 private:
  const TargetBoard& board_;
  std::vector<const TargetMarker*> markers_;
};

TargetPattern::TargetPattern(const TargetBoard& board) {
  const std::string faults = faultsOf(board);
  if (!faults.empty()) throw std::invalid_argument(faults);
  const auto squares = [&](Lines& lines, int count) {
    lines.at_mm = {-board.margin_mm, count * board.square_mm + board.margin_mm};
    for (int i = 0; i <= count; ++i) lines.at_mm.push_back(i * board.square_mm);
  };
  squares(x_, board.columns);
  squares(y_, board.rows);
  const double border_mm = 0.5 * (board.square_mm - board.marker_mm);
  for (const TargetMarker& marker : board.markers) {
    for (int i = 0; i <= board.marker_cells; ++i) {
      const double within_mm = border_mm + board.marker_mm * i / board.marker_cells;
      x_.at_mm.push_back(marker.column * board.square_mm + within_mm);
      y_.at_mm.push_back(marker.row * board.square_mm + within_mm);
    }
  }
  x_.finish();
  y_.finish();
  const auto middle = [](const std::vector<double>& lines, std::size_t cell) {
    if (cell == 0) return lines.front() - 1.0;
    if (cell == lines.size()) return lines.back() + 1.0;
    return 0.5 * (lines[cell - 1] + lines[cell]);
  };
  const Print print(board);
  for (std::size_t row = 0; row <= y_.at_mm.size(); ++row) {
    for (std::size_t column = 0; column <= x_.at_mm.size(); ++column)
      gray_.push_back(print.at({middle(x_.at_mm, column), middle(y_.at_mm, row)}));
  }
}

double TargetPattern::grayAt(const Vector2d& p_B_mm) const {
  return cell(x_.below(p_B_mm.x()), y_.below(p_B_mm.y()));
}

double TargetPattern::blurredAt(const Vector2d& p_B_mm, const Eigen::Matrix2d& covariance_mm2,
                                Scratch& scratch) const {
  const Vector2d sigma_mm = covariance_mm2.diagonal().cwiseSqrt();
  const std::size_t left = x_.below(p_B_mm.x() - kReach * sigma_mm.x());
  const std::size_t right = x_.below(p_B_mm.x() + kReach * sigma_mm.x());
  const std::size_t top = y_.below(p_B_mm.y() - kReach * sigma_mm.y());
  const std::size_t bottom = y_.below(p_B_mm.y() + kReach * sigma_mm.y());
  double gray = cell(left, top);
  const auto look = [](const Lines& lines, std::size_t begin, std::size_t end, double place_mm, double sigma,
                       std::vector<double>& scaled, std::vector<double>& share) {
    scaled.clear();
    share.clear();
    for (std::size_t i = begin; i < end; ++i) {
      scaled.push_back((place_mm - lines.at_mm[i]) / sigma);
      share.push_back(upTo(scaled.back()));
    }
  };
  // The mean of a lattice is its first cell and the steps at its lines, each weighted by the share beyond it.
  if (left < right) look(x_, left, right, p_B_mm.x(), sigma_mm.x(), scratch.scaled_x, scratch.share_x);
  if (top < bottom) look(y_, top, bottom, p_B_mm.y(), sigma_mm.y(), scratch.scaled_y, scratch.share_y);
  for (std::size_t i = left; i < right; ++i)
    gray += (cell(i + 1, top) - cell(i, top)) * scratch.share_x[i - left];
  for (std::size_t j = top; j < bottom; ++j)
    gray += (cell(left, j + 1) - cell(left, j)) * scratch.share_y[j - top];
  const double correlation = covariance_mm2(0, 1) / (sigma_mm.x() * sigma_mm.y());
  for (std::size_t j = top; j < bottom; ++j) {
    for (std::size_t i = left; i < right; ++i) {
      const double step = cell(i + 1, j + 1) - cell(i, j + 1) - cell(i + 1, j) + cell(i, j);
      if (step == 0.0) continue;
      gray += step * (scratch.share_x[i - left] * scratch.share_y[j - top] +
                      addedByCorrelation(scratch.scaled_x[i - left], scratch.scaled_y[j - top], correlation));
    }
  }
  return gray;
}

}  // namespace kerfbench::twin
