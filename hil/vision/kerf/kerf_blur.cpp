// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_blur.h"

#include <cmath>
#include <span>

#include "twin/base/multiversion.h"

namespace kerfbench::vision {
namespace {

/// Sums of so many neighbouring places at once; each sum is taken in the order of the weights.
KERFBENCH_WIDE void convolve(const double* from, std::span<const double> weights, std::span<double, 16> out) {
  std::array<double, 16> sums{};
  for (std::size_t k = 0; k < weights.size(); ++k) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weights[k] * from[k + i];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) out[i] = sums[i];
}

}  // namespace

BlurKernel::BlurKernel(double sigma, int reach_) : reach(reach_) {
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += weights.back();
  }
}

BlurredProfile::Block BlurredProfile::blockFrom(std::size_t first) const {
  Block block;
  convolve(padded_.data() + first, kernel_.weights, block);
  for (double& value : block) value /= kernel_.sum;
  return block;
}

}  // namespace kerfbench::vision
