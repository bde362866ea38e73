// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "hil/vision/kerf/kerf_profile.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

constexpr double kApartMm = 0.35;  // Distance of readings that share neither pixel nor grain.
constexpr double kGain = 20.0;     // Variance of a third difference over that of a reading.
constexpr double kPoolMm = 6.0;    // Half length of the pool.
constexpr double kBelief = 12.0;   // Weight of what other cuts show, in third differences.
constexpr double kClipSigmas = 3.0;
constexpr double kClipped = 0.9850;  // Variance left by clipping a normal value at kClipSigmas.
constexpr double kLeast_mm = 1e-5;
constexpr double kGridPx = 0.009;
// Largest scatter by noise of readings 0.35 mm apart, in the variance that neighbours and plain board show.
// Edges that are rough over 0.06 mm, the worst noise seen, had 2.1 times as much; a beam that follows steps
// of its mirrors has 5 … 30 times.
constexpr double kMostByNoise = 2.5;
constexpr double kGrainInFlank = 0.33;  // Variance by grain in a flank over that on plain board.

/// Variance of a third difference of readings so far apart, in that of one reading: windows that overlap
/// share pixels.
double gainOf(double apart_mm) {
  const auto shared = [&](double times) {
    return std::max(0.0, 1.0 - times * apart_mm / (2.0 * kWindowHalfMm));
  };
  return kGain - 30.0 * shared(1.0) + 12.0 * shared(2.0) - 2.0 * shared(3.0);
}

/// Squares of the third differences along one entity, in units of one reading's variance; NaN where a reading
/// is missing. Entry i is centred between its readings, at the station of reading i plus 1.5 gaps.
struct Differences {
  std::vector<double> squares;
  std::vector<double> predicted;  ///< The mean variance that the pixels alone make, of the same readings.
  std::size_t gap{};
};

template <typename Reading>
Differences differencesOf(const EntityPlan& plan, const EntityKerf& kerf, const CutNoise& cut,
                          double apart_mm, const Reading& reading) {
  Differences out;
  const std::size_t n = kerf.calipers.size();
  if (n < 2) return out;
  const double pitch_mm = plan.length_mm / static_cast<double>(n - 1);
  out.gap = static_cast<std::size_t>(std::max(1.0, std::ceil(std::min(apart_mm / pitch_mm, 1e6))));
  const double gain = gainOf(static_cast<double>(out.gap) * pitch_mm);
  for (std::size_t i = 0; i + 3 * out.gap < n; ++i) {
    double difference = 0.0;
    double variance = 0.0;
    constexpr double kWeights[] = {1.0, -3.0, 3.0, -1.0};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t at = i + k * out.gap;
      const Caliper& c = kerf.calipers[at];
      difference += c.found && !c.near_joint ? kWeights[k] * reading(c, cut, at) : kNan;
      variance += kWeights[k] * kWeights[k] * cut.pixels_mm[at] * cut.pixels_mm[at];
    }
    out.squares.push_back(difference * difference / gain);
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

/// Mean variance of a reading: seen, and as the pixels alone would make it.
struct Variance {
  double seen{};
  double predicted{};
};

/// The scatter of one kind of reading along all entities.
class Scatter {
 public:
  template <typename Reading>
  Scatter(const KerfPlan& plan, const std::vector<CutNoise>& noise, const std::vector<EntityKerf>& kerfs,
          double apart_mm, const Reading& reading)
      : plan_(plan) {
    for (std::size_t e = 0; e < kerfs.size(); ++e)
      all_.push_back(differencesOf(plan.entities[e], kerfs[e], noise[e], apart_mm, reading));
    std::map<dieline::Process, double> limits;
    for (std::size_t e = 0; e < kerfs.size(); ++e) {
      const dieline::Process process = plan.entities[e].process;
      if (!limits.contains(process)) limits[process] = clipLimit(process);
      std::vector<Pool>& sums = sums_.emplace_back(1);
      for (std::size_t i = 0; i < all_[e].squares.size(); ++i) {
        of_process_[process].add(all_[e], i, limits[process]);
        sums.push_back(sums.back());
        sums.back().add(all_[e], i, limits[process]);
      }
    }
  }

  /// Variance around a station; nullopt where no cut of the process has differences.
  [[nodiscard]] std::optional<Variance> around(std::size_t entity, std::size_t station,
                                               double pitch_mm) const {
    const auto of_process = of_process_.find(plan_.entities[entity].process);
    if (of_process == of_process_.end() || !(of_process->second.count > 0.0)) return std::nullopt;
    const Pool& all = of_process->second;
    const auto pool = static_cast<std::ptrdiff_t>(kPoolMm / pitch_mm);
    const auto last = static_cast<std::ptrdiff_t>(all_[entity].squares.size());
    const auto centre =
        static_cast<std::ptrdiff_t>(station) - static_cast<std::ptrdiff_t>(3 * all_[entity].gap / 2);
    const auto from = std::clamp<std::ptrdiff_t>(centre - pool, 0, last);
    const auto to = std::clamp<std::ptrdiff_t>(centre + pool + 1, from, last);
    const std::vector<Pool>& sums = sums_[entity];
    const Pool near = sums[static_cast<std::size_t>(to)].without(sums[static_cast<std::size_t>(from)]);
    const double belief = kBelief / all.count;
    const double weight = near.count + kBelief;
    return Variance{(near.squares + belief * all.squares) / weight,
                    (near.predicted + belief * all.predicted) / weight};
  }

 private:
  /// Where third differences begin to be steps rather than noise.
  [[nodiscard]] double clipLimit(dieline::Process process) const {
    std::vector<double> squares;
    for (std::size_t e = 0; e < all_.size(); ++e) {
      if (plan_.entities[e].process != process) continue;
      std::copy_if(all_[e].squares.begin(), all_[e].squares.end(), std::back_inserter(squares),
                   [](double s) { return std::isfinite(s); });
    }
    if (squares.empty()) return std::numeric_limits<double>::infinity();
    return kClipSigmas * kClipSigmas * upperMedianIn(squares) / kMedianSquare;
  }

  const KerfPlan& plan_;
  std::vector<Differences> all_;
  std::vector<std::vector<Pool>> sums_;  ///< Sums of each entity, up to each difference.
  std::map<dieline::Process, Pool> of_process_;
};

/// Standard deviation of one reading by the scatter around it and its own share of the pixels' noise.
double sigmaOf(const std::optional<Variance>& around, double noise_mm) {
  if (!around) return std::max(kLeast_mm, noise_mm);
  const double own = noise_mm * noise_mm;
  const double variance = around->seen > around->predicted ? own + around->seen - around->predicted
                                                           : around->seen * own / around->predicted;
  return std::max(kLeast_mm, std::sqrt(variance));
}

}  // namespace

double gridNoisePx(const Eigen::Vector2d& window_along_px) {
  const double rows = std::min(std::abs(window_along_px.x()), std::abs(window_along_px.y()));
  if (rows < 1e-6) return kGridPx;
  const double phase = std::numbers::pi * rows;
  return kGridPx * std::abs(std::sin(phase) / phase);
}

void setSigmas(const KerfPlan& plan, const std::vector<CutNoise>& noise, std::vector<EntityKerf>& kerfs) {
  const auto offset = [](const Caliper& c, const CutNoise&, std::size_t) { return c.offset_mm; };
  const auto width = [](const Caliper& c, const CutNoise&, std::size_t) { return 0.5 * c.width_mm; };
  const auto board = [](const Caliper&, const CutNoise& cut, std::size_t i) { return cut.board_mm[i]; };
  const Scatter offsets(plan, noise, kerfs, kApartMm, offset);
  const Scatter neighbours(plan, noise, kerfs, 0.0, offset);
  const Scatter boards(plan, noise, kerfs, kApartMm, board);
  const Scatter half_widths(plan, noise, kerfs, kApartMm, width);
  for (std::size_t e = 0; e < kerfs.size(); ++e) {
    const std::size_t n = kerfs[e].calipers.size();
    const double pitch_mm = n > 1 ? plan.entities[e].length_mm / static_cast<double>(n - 1) : 1.0;
    for (std::size_t i = 0; i < n; ++i) {
      Caliper& c = kerfs[e].calipers[i];
      if (!c.found) continue;
      std::optional<Variance> around = offsets.around(e, i, pitch_mm);
      const auto near = neighbours.around(e, i, pitch_mm);
      const auto beside = boards.around(e, i, pitch_mm);
      if (around && near) {
        const double grain = beside ? kGrainInFlank * beside->seen : 0.0;
        around->seen = std::min(around->seen, kMostByNoise * (near->seen + grain));
      }
      const double pixels_mm = noise[e].pixels_mm[i];
      c.steady_sigma_mm = std::hypot(noise[e].grid_mm[i], noise[e].model_mm[i]);
      c.sigma_mm = std::hypot(sigmaOf(around, pixels_mm), c.steady_sigma_mm);
      c.width_sigma_mm =
          2.0 * std::hypot(sigmaOf(half_widths.around(e, i, pitch_mm), pixels_mm), c.steady_sigma_mm);
    }
  }
}

}  // namespace kerfbench::vision
