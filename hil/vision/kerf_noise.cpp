// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace kerfbench::hil {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kApartMm = 0.35;  // of readings that share neither pixel nor grain
constexpr double kGain = 20.0;     // of a third difference, on the variance
constexpr double kPoolMm = 6.0;    // each way
constexpr double kBelief = 12.0;   // third differences worth, in what other cuts show
constexpr double kClipSigmas = 3.0;
constexpr double kClipped = 0.9850;       // variance left by clipping a normal value there
constexpr double kMedianSquare = 0.4549;  // of a standard normal value
constexpr double kLeast_mm = 1e-5;
constexpr double kGridPx = 0.009;

/// Squares of the third differences along one entity, in units of one reading's variance; NaN where a reading
/// is missing. Entry i is centred between its readings, at the station of reading i plus 1.5 gaps.
struct Differences {
  std::vector<double> squares;
  std::vector<double> predicted;  ///< The mean variance that the pixels alone make, of the same readings.
  std::size_t gap{};
};

template <typename Reading>
Differences differencesOf(const EntityPlan& plan, const EntityKerf& kerf, const std::vector<double>& noise,
                          const Reading& reading) {
  Differences out;
  const std::size_t n = kerf.calipers.size();
  if (n < 2) return out;
  const double pitch_mm = plan.length_mm / static_cast<double>(n - 1);
  out.gap = static_cast<std::size_t>(std::ceil(std::min(kApartMm / pitch_mm, 1e6)));
  for (std::size_t i = 0; i + 3 * out.gap < n; ++i) {
    double difference = 0.0;
    double variance = 0.0;
    constexpr double kWeights[] = {1.0, -3.0, 3.0, -1.0};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t at = i + k * out.gap;
      const Caliper& c = kerf.calipers[at];
      difference += c.found && !c.near_joint ? kWeights[k] * reading(c) : kNan;
      variance += kWeights[k] * kWeights[k] * noise[at] * noise[at];
    }
    out.squares.push_back(difference * difference / kGain);
    out.predicted.push_back(variance / kGain);
  }
  return out;
}

/// Sums of a stretch of differences.
struct Pool {
  double count{};
  double squares{};
  double predicted{};

  void add(const Differences& d, std::size_t i, double limit) {
    if (!std::isfinite(d.squares[i])) return;
    count += 1.0;
    squares += std::min(d.squares[i], limit) / kClipped;
    predicted += d.predicted[i];
  }
  [[nodiscard]] Pool without(const Pool& o) const {
    return {count - o.count, squares - o.squares, predicted - o.predicted};
  }
};

/// Where third differences begin to be steps rather than noise.
double clipLimit(const std::vector<Differences>& all, const KerfPlan& plan, Process process) {
  std::vector<double> squares;
  for (std::size_t e = 0; e < all.size(); ++e) {
    if (plan.entities[e].process != process) continue;
    std::copy_if(all[e].squares.begin(), all[e].squares.end(), std::back_inserter(squares),
                 [](double s) { return std::isfinite(s); });
  }
  if (squares.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return kClipSigmas * kClipSigmas * *middle / kMedianSquare;
}

/// Standard deviation of one reading by the scatter around it and its own share of the pixels' noise.
double sigmaOf(const Pool& near, const Pool& all, double noise_mm) {
  const double own = noise_mm * noise_mm;
  if (!(all.count > 0.0)) return std::max(kLeast_mm, noise_mm);
  const double belief = kBelief / all.count;
  const double weight = near.count + kBelief;
  const double scatter = (near.squares + belief * all.squares) / weight;
  const double predicted = (near.predicted + belief * all.predicted) / weight;
  const double variance = scatter > predicted ? own + scatter - predicted : scatter * own / predicted;
  return std::max(kLeast_mm, std::sqrt(variance));
}

template <typename Reading, typename Sigma>
void setSigma(const KerfPlan& plan, const std::vector<CutNoise>& noise, double noise_gain,
              std::vector<EntityKerf>& kerfs, const Reading& reading, const Sigma& sigma) {
  std::vector<Differences> all;
  std::vector<std::vector<double>> scaled;
  for (const CutNoise& entity : noise) {
    scaled.push_back(entity.pixels_mm);
    for (double& value : scaled.back()) value *= noise_gain;
  }
  for (std::size_t e = 0; e < kerfs.size(); ++e)
    all.push_back(differencesOf(plan.entities[e], kerfs[e], scaled[e], reading));
  std::map<Process, Pool> of_process;
  std::map<Process, double> limits;
  for (std::size_t e = 0; e < kerfs.size(); ++e) {
    const Process process = plan.entities[e].process;
    if (!limits.contains(process)) limits[process] = clipLimit(all, plan, process);
    for (std::size_t i = 0; i < all[e].squares.size(); ++i)
      of_process[process].add(all[e], i, limits[process]);
  }
  for (std::size_t e = 0; e < kerfs.size(); ++e) {
    const Process process = plan.entities[e].process;
    const Differences& d = all[e];
    std::vector<Pool> sums(1);
    for (std::size_t i = 0; i < d.squares.size(); ++i) {
      sums.push_back(sums.back());
      sums.back().add(d, i, limits[process]);
    }
    const std::size_t n = kerfs[e].calipers.size();
    const double pitch_mm = n > 1 ? plan.entities[e].length_mm / static_cast<double>(n - 1) : 1.0;
    const auto pool = static_cast<std::ptrdiff_t>(kPoolMm / pitch_mm);
    for (std::size_t i = 0; i < n; ++i) {
      const auto last = static_cast<std::ptrdiff_t>(d.squares.size());
      const auto centre = static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(3 * d.gap / 2);
      const auto from = std::clamp<std::ptrdiff_t>(centre - pool, 0, last);
      const auto to = std::clamp<std::ptrdiff_t>(centre + pool + 1, from, last);
      const Pool near = sums[static_cast<std::size_t>(to)].without(sums[static_cast<std::size_t>(from)]);
      Caliper& c = kerfs[e].calipers[i];
      const double grid_mm = noise_gain * std::hypot(noise[e].grid_mm[i], noise[e].model_mm[i]);
      sigma(c) = c.found ? std::hypot(sigmaOf(near, of_process[process], scaled[e][i]), grid_mm) : kNan;
    }
  }
}

}  // namespace

double gridNoisePx(const Eigen::Vector2d& window_along_px) {
  const double rows = std::min(std::abs(window_along_px.x()), std::abs(window_along_px.y()));
  if (rows < 1e-6) return kGridPx;
  const double phase = std::numbers::pi * rows;
  return kGridPx * std::abs(std::sin(phase) / phase);
}

void setSigmas(const KerfPlan& plan, const std::vector<CutNoise>& noise, std::vector<EntityKerf>& kerfs) {
  setSigma(
      plan, noise, 1.0, kerfs, [](const Caliper& c) { return c.offset_mm; },
      [](Caliper& c) -> double& { return c.sigma_mm; });
  // The difference of two flanks where the offset is their mean.
  setSigma(
      plan, noise, 2.0, kerfs, [](const Caliper& c) { return c.width_mm; },
      [](Caliper& c) -> double& { return c.width_sigma_mm; });
}

}  // namespace kerfbench::hil
