// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/board_field.h"

#include <array>
#include <cmath>

#include "twin/camera/sensor_noise.h"

namespace kerfbench::twin {
namespace {

// White noise in a cubic B-spline is correlated as the B-spline of degree seven: 1/e at this many nodes. The
// variance along one axis is that spline's middle.
constexpr double kLengthInNodes = 1.184695871;
constexpr double kVariance = 151.0 / 315.0;

}  // namespace

BoardField::BoardField(std::uint64_t seed, std::uint64_t stream, double length_mm)
    : random_(seed, stream), pitch_mm_(length_mm / kLengthInNodes) {}

void BoardField::copyNodes(int column, int row, int columns, int rows, std::span<float> out) const {
  const std::array<float, 4096>& quantiles = normalQuantiles();
  const auto scale = static_cast<float>(1.0 / kVariance);
  std::size_t i = 0;
  for (int y = row; y < row + rows; ++y) {
    const std::uint64_t line = static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32U;
    int x = column;
    while (x < column + columns) {
      // Four neighbours share 64 random bits.
      const int first = x & ~3;
      std::uint64_t bits = random_.bits(line | static_cast<std::uint32_t>(first));
      bits >>= 16U * static_cast<unsigned>(x - first);
      for (; x < first + 4 && x < column + columns; ++x, bits >>= 16U)
        out[i++] = scale * quantiles[bits % quantiles.size()];
    }
  }
}

double BoardField::at(const Eigen::Vector2d& p_mm) const {
  const Eigen::Vector2d place = p_mm / pitch_mm_;
  const Eigen::Vector2d node = place.array().floor().matrix();
  std::array<float, 16> nodes{};
  copyNodes(static_cast<int>(node.x()) - 1, static_cast<int>(node.y()) - 1, 4, 4, nodes);
  return static_cast<double>(splineValue(nodes.data(), 4,
                                         splineWeights(static_cast<float>(place.x() - node.x())),
                                         splineWeights(static_cast<float>(place.y() - node.y()))));
}

void FieldWindow::fill(const BoardField& field, const Eigen::AlignedBox2d& box_nodes) {
  // The spline needs one node less: a patch may bulge a little between its corners.
  column_ = static_cast<int>(std::floor(box_nodes.min().x())) - 2;
  row_ = static_cast<int>(std::floor(box_nodes.min().y())) - 2;
  const int columns = static_cast<int>(std::floor(box_nodes.max().x())) + 4 - column_;
  const int rows = static_cast<int>(std::floor(box_nodes.max().y())) + 4 - row_;
  stride_ = columns;
  nodes_.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  field.copyNodes(column_, row_, columns, rows, nodes_);
}

void FieldPainter::add(const PlanePatch::Nodes& p_S_mm, int width, int height, float scale,
                       std::span<float> out) {
  PlanePatch::Nodes places;
  Eigen::AlignedBox2d box;
  for (std::size_t n = 0; n < places.size(); ++n) {
    places[n] = p_S_mm[n] / field_.nodePitch_mm();
    box.extend(places[n]);
  }
  window_.fill(field_, box);
  const PlanePatch patch(places);
  float* pixel = out.data();
  for (int y = 0; y < height; ++y) {
    const double t = (y + 0.5) / height;
    const Eigen::Vector2f c0 = (patch.alongRow(t, 0) - window_.origin()).cast<float>();
    const Eigen::Vector2f c1 = patch.alongRow(t, 1).cast<float>();
    const Eigen::Vector2f c2 = patch.alongRow(t, 2).cast<float>();
    const float step = 1.0F / static_cast<float>(width);
    for (int x = 0; x < width; ++x) {
      const float s = (static_cast<float>(x) + 0.5F) * step;
      *pixel++ += scale * window_.at(c0.x() + s * (c1.x() + s * c2.x()), c0.y() + s * (c1.y() + s * c2.y()),
                                     weights_);
    }
  }
}

}  // namespace kerfbench::twin
