// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/board_description.h"

#include <cmath>

namespace kerfbench::twin {
namespace {

bool isDepthCurve(const std::vector<DepthPoint>& curve) {
  if (curve.empty()) return true;
  if (curve.size() < 2) return false;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    if (!(curve[i].fluence_share < curve[i + 1].fluence_share &&
          curve[i].depth_share < curve[i + 1].depth_share))
      return false;
  }
  return curve.front().fluence_share >= 0.0 && curve.front().depth_share == 0.0 &&
         curve.back().fluence_share == 1.0 && curve.back().depth_share == 1.0;
}

}  // namespace

double lightThrough(LightLaw law, double transmission, double left) {
  switch (law) {
    case LightLaw::kScatter:
      return 1.0 / (1.0 + left * (1.0 / transmission - 1.0));
    case LightLaw::kLinear:
      return 1.0 - left * (1.0 - transmission);
    case LightLaw::kBeer:
      break;
  }
  return std::pow(transmission, left);
}

std::string faultsOf(const BoardDescription& board) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "board: " : "; ") + std::string(rule);
  };
  const ScorchDescription& scorch = board.scorch;
  require(board.thickness_mm > 0.0 && std::isfinite(board.thickness_mm), "thickness_mm must be > 0");
  require(board.cut_fluence_j_mm2 > 0.0 && std::isfinite(board.cut_fluence_j_mm2),
          "cut_fluence_j_mm2 must be > 0");
  require(isDepthCurve(board.depth_curve),
          "depth_curve must ascend strictly in both, from depth 0 at a fluence >= 0 to (1, 1)");
  require(board.transmission > 0.0 && board.transmission < 1.0, "transmission must be in (0, 1)");
  require(board.print_transmission > 0.0 && board.print_transmission <= board.transmission,
          "print_transmission must be in (0, transmission]");
  require(scorch.fluence_j_mm2 >= 0.0 && std::isfinite(scorch.fluence_j_mm2),
          "scorch.fluence_j_mm2 must be >= 0");
  require(scorch.darkening >= 0.0 && scorch.darkening <= 1.0, "scorch.darkening must be in [0, 1]");
  require(std::abs(scorch.shift_mm[0]) <= 1.0 && std::abs(scorch.shift_mm[1]) <= 1.0,
          "scorch.shift_mm must be in [-1, 1]");
  return faults;
}

}  // namespace kerfbench::twin
