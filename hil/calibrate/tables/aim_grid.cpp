// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/tables/aim_grid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kStencil = 5;
constexpr double kBorder_mm = 1e-9;

void checkPlaces(const char* axis, const std::vector<double>& places, std::size_t least,
                 std::string& faults) {
  if (places.size() < least || places.size() > AimGrid::kMostNodes)
    faults += fmt::format("{} has {} nodes, not {} to {}\n", axis, places.size(), least, AimGrid::kMostNodes);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!std::isfinite(places[i])) {
      faults += fmt::format("{} of node {} is not finite\n", axis, i);
    } else if (i > 0 && places[i] <= places[i - 1]) {
      faults += fmt::format("{} must ascend: {:g} after {:g}\n", axis, places[i], places[i - 1]);
    }
  }
}

/// The cell of a place, the first or last for one outside, and how far in it: 0 … 1 inside.
struct InCell {
  std::size_t cell;
  double width, share;
  InCell(const std::vector<double>& nodes, double place)
      : cell(static_cast<std::size_t>(std::upper_bound(nodes.begin() + 1, nodes.end() - 1, place) -
                                      nodes.begin()) -
             1),
        width(nodes[cell + 1] - nodes[cell]),
        share((place - nodes[cell]) / width) {}
};

/// Derivative at node `i` of the polynomial through its neighbours: weights in barycentric form (Berrut and
/// Trefethen 2004, eq. 9.4).
struct SlopeWeights {
  std::size_t first{};
  std::vector<double> weight;
  SlopeWeights(const std::vector<double>& nodes, std::size_t i) {
    const std::size_t count = std::min(kStencil, nodes.size());
    first = std::min(i > count / 2 ? i - count / 2 : 0, nodes.size() - count);
    const auto barycentric = [&](std::size_t j) {
      double product = 1.0;
      for (std::size_t k = first; k < first + count; ++k) {
        if (k != j) product *= nodes[j] - nodes[k];
      }
      return 1.0 / product;
    };
    weight.assign(count, 0.0);
    const double own = barycentric(i);
    for (std::size_t j = first; j < first + count; ++j) {
      if (j == i) continue;
      weight[j - first] = barycentric(j) / own / (nodes[i] - nodes[j]);
      weight[i - first] -= weight[j - first];
    }
  }
  template <typename At>
  [[nodiscard]] Vector2d slope(const At& at) const {
    Vector2d sum = Vector2d::Zero();
    for (std::size_t k = 0; k < weight.size(); ++k) sum += weight[k] * at(first + k);
    return sum;
  }
};

/// The cubic on [0, 1] with these values and slopes (per unit share) at its ends.
Vector2d cubic(const Vector2d& f0, const Vector2d& f1, const Vector2d& s0, const Vector2d& s1, double u) {
  const Vector2d rise = f1 - f0;
  return f0 + u * (s0 + u * ((3.0 * rise - 2.0 * s0 - s1) + u * (s0 + s1 - 2.0 * rise)));
}

}  // namespace

AimGrid::AimGrid(std::vector<double> x_mm, std::vector<double> y_mm, std::vector<Vector2d> d_mm,
                 Between between, Outside outside)
    : x_(std::move(x_mm)), y_(std::move(y_mm)), d_(std::move(d_mm)), between_(between), outside_(outside) {
  std::string faults;
  const std::size_t least = between == Between::kHermite ? 3 : 2;
  checkPlaces("x", x_, least, faults);
  checkPlaces("y", y_, least, faults);
  if (d_.size() != x_.size() * y_.size())
    faults += fmt::format("{} values for {} x {} nodes\n", d_.size(), x_.size(), y_.size());
  const auto bad = std::ranges::find_if(d_, [](const Vector2d& d) { return !d.allFinite(); });
  if (bad != d_.end()) faults += fmt::format("value {} is not finite\n", bad - d_.begin());
  if (!faults.empty()) {
    faults.pop_back();
    throw std::invalid_argument(faults);
  }
  if (between_ == Between::kHermite) setSlopes();
}

void AimGrid::setSlopes() {
  const std::size_t columns = x_.size();
  slopes_.resize(d_.size());
  for (std::size_t column = 0; column < columns; ++column) {
    const SlopeWeights weights(x_, column);
    for (std::size_t row = 0; row < y_.size(); ++row)
      slopes_[row * columns + column][0] = weights.slope([&](std::size_t k) { return d_mm(k, row); });
  }
  for (std::size_t row = 0; row < y_.size(); ++row) {
    const SlopeWeights weights(y_, row);
    for (std::size_t column = 0; column < columns; ++column) {
      Slopes& here = slopes_[row * columns + column];
      here[1] = weights.slope([&](std::size_t k) { return d_mm(column, k); });
      here[2] = weights.slope([&](std::size_t k) { return slopes_[k * columns + column][0]; });
    }
  }
}

Eigen::AlignedBox2d AimGrid::area_W_mm() const {
  return {Vector2d(x_.front(), y_.front()), Vector2d(x_.back(), y_.back())};
}

std::optional<Vector2d> AimGrid::at_mm(const Vector2d& p_W_mm) const {
  if (!p_W_mm.allFinite()) return std::nullopt;
  const Eigen::AlignedBox2d area = area_W_mm();
  const double outside_mm = area.exteriorDistance(p_W_mm);
  if (outside_mm > kBorder_mm && outside_ == Outside::kRefused) return std::nullopt;
  if (outside_mm > 0.0 && outside_ == Outside::kLinear) return bilinear(p_W_mm);
  const Vector2d p = p_W_mm.cwiseMax(area.min()).cwiseMin(area.max());
  return between_ == Between::kHermite ? hermite(p) : bilinear(p);
}

Vector2d AimGrid::bilinear(const Vector2d& p) const {
  const InCell u(x_, p.x());
  const InCell v(y_, p.y());
  const auto along = [&](std::size_t row) -> Vector2d {
    return (1.0 - u.share) * d_mm(u.cell, row) + u.share * d_mm(u.cell + 1, row);
  };
  return (1.0 - v.share) * along(v.cell) + v.share * along(v.cell + 1);
}

Vector2d AimGrid::hermite(const Vector2d& p) const {
  const InCell u(x_, p.x());
  const InCell v(y_, p.y());
  // Along x at both rows, value and slope across; then along y.
  std::array<Vector2d, 2> value, slope;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t left = (v.cell + k) * x_.size() + u.cell;
    const Slopes& at0 = slopes_[left];
    const Slopes& at1 = slopes_[left + 1];
    value.at(k) = cubic(d_[left], d_[left + 1], u.width * at0[0], u.width * at1[0], u.share);
    slope.at(k) = cubic(at0[1], at1[1], u.width * at0[2], u.width * at1[2], u.share);
  }
  return cubic(value[0], value[1], v.width * slope[0], v.width * slope[1], v.share);
}

AimGrid AimGrid::with(Between between, Outside outside) const { return {x_, y_, d_, between, outside}; }

std::vector<double> evenly(double low, double high, std::size_t count) {
  std::vector<double> places;
  const auto last = static_cast<double>(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / last;
    places.push_back((1.0 - share) * low + share * high);
  }
  return places;
}

AimGrid resampled(const AimGrid& from, std::vector<double> x_mm, std::vector<double> y_mm, Between between,
                  Outside outside) {
  std::vector<Vector2d> d_mm;
  for (const double y : y_mm) {
    for (const double x : x_mm) {
      const auto d = from.at_mm({x, y});
      if (!d) {
        const Eigen::AlignedBox2d area = from.area_W_mm();
        throw std::invalid_argument(
            fmt::format("the node ({:g}, {:g}) mm lies outside of the table, which covers x {:g} … {:g}, y "
                        "{:g} … {:g} mm",
                        x, y, area.min().x(), area.max().x(), area.min().y(), area.max().y()));
      }
      d_mm.push_back(*d);
    }
  }
  return {std::move(x_mm), std::move(y_mm), std::move(d_mm), between, outside};
}

}  // namespace kerfbench::calibrate
