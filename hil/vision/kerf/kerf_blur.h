// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace kerfbench::vision {

/// A Gaussian, sampled at whole steps.
struct BlurKernel {
  /// `sigma` and `reach` in steps; the sampled Gaussian ends at the reach, both ways.
  BlurKernel(double sigma, int reach);

  std::vector<double> weights;  ///< From -reach to reach.
  int reach;
  double sum{};  ///< Sum of the weights.
};

/// A profile as it looks blurred. A look for where it falls needs but few of its samples: they are computed
/// in blocks, when they are asked for.
class BlurredProfile {
 public:
  /// The profile has size() samples; `sampleAt(i)` is sample i; those beyond the ends are asked for, too.
  template <typename Sample>
  BlurredProfile(std::size_t size, const BlurKernel& kernel, const Sample& sampleAt)
      : kernel_(kernel), size_(size), blocks_((size + kBlock - 1) / kBlock) {
    const int end = static_cast<int>(blocks_.size() * kBlock) + kernel.reach;
    padded_.reserve(static_cast<std::size_t>(end + kernel.reach));
    for (int at = -kernel.reach; at < end; ++at) padded_.push_back(sampleAt(at));
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] double operator[](std::size_t i) {
    std::optional<Block>& block = blocks_[i / kBlock];
    if (!block) block = blockFrom(i / kBlock * kBlock);
    return (*block)[i % kBlock];
  }

 private:
  static constexpr std::size_t kBlock = 16;
  using Block = std::array<double, kBlock>;
  [[nodiscard]] Block blockFrom(std::size_t first) const;

  const BlurKernel& kernel_;
  std::size_t size_;
  std::vector<double> padded_;
  std::vector<std::optional<Block>> blocks_;
};

}  // namespace kerfbench::vision
