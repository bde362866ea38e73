// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/worst_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/QR>

#include "hil/inspect/extreme_budget.h"
#include "hil/inspect/line_smoother.h"
#include "twin/base/random.h"

namespace kerfbench::hil {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kDraws = 500;

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = v != v ? kNan : std::max(most, std::abs(v));
  return most;
}

double sumOfSquares(const std::vector<double>& values, LineKind::Rms about) {
  if (values.empty()) return 0.0;
  double sum = 0.0;
  double mean = 0.0;
  for (const double v : values) {
    sum += v * v;
    mean += v / static_cast<double>(values.size());
  }
  return about == LineKind::Rms::kAboutZero ? sum : sum - mean * mean * static_cast<double>(values.size());
}

/// Offset, slope, bend and one turn of a sine: what a shift, a turn, a scale and a wrong centre make.
Eigen::MatrixXd trendBasis(std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd basis(n, 5);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = n > 1 ? 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0 : 0.0;
    const double angle = std::numbers::pi * t;
    basis.row(i) << 1.0, t, t * t, std::cos(angle), std::sin(angle);
  }
  return basis.leftCols(std::min<Eigen::Index>(5, n));
}

/// Range of what is left after the least-squares circle.
class Roundness {
 public:
  explicit Roundness(const std::vector<double>& angle_rad) {
    const auto n = static_cast<Eigen::Index>(angle_rad.size());
    basis_.resize(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double angle = angle_rad[static_cast<std::size_t>(i)];
      basis_.row(i) << 1.0, std::cos(angle), std::sin(angle);
    }
    solver_.compute(basis_);
  }
  [[nodiscard]] double of(const std::vector<double>& offset_mm) const {
    const Eigen::Map<const Eigen::VectorXd> x(offset_mm.data(), static_cast<Eigen::Index>(offset_mm.size()));
    const Eigen::VectorXd rest = x - basis_ * solver_.solve(x);
    return rest.maxCoeff() - rest.minCoeff();
  }

 private:
  Eigen::MatrixXd basis_;
  Eigen::HouseholderQR<Eigen::MatrixXd> solver_;
};

/// One line with all that simulated measurements of it need.
class Simulated {
 public:
  Simulated(const ReadingLine& line, const LineKind& kind)
      : line_(line), smoother_(line), noise_(line.size()) {
    rms = kind.rms;
    smoother_.smooth(line.reading_mm, estimate_mm, &level);
    likely_mm = likelyTruth();
    if (kind.is_circle && line.size() >= 8 && kind.angle_rad.size() == line.size())
      roundness_.emplace(kind.angle_rad);
    for (std::size_t i = 0; i < line.size(); ++i) {
      error_squares +=
          line.sigma_mm[i] * line.sigma_mm[i] + line.shared.row(static_cast<Eigen::Index>(i)).squaredNorm();
    }
  }

  /// Readings of the likely truth with noise of the given stream and the shared errors e.
  void measure(const CounterRandom& noise, std::uint64_t first, const Eigen::VectorXd& shared_error) {
    const Eigen::VectorXd shift = line_.shared * shared_error;
    const double innovation = std::sqrt(1.0 - line_.q * line_.q);
    normals(noise, first, noise_);
    reading_mm.resize(line_.size());
    for (std::size_t s = 0; s + 1 < line_.segment.size(); ++s) {
      double z = 0.0;
      for (std::size_t i = line_.segment[s]; i < line_.segment[s + 1]; ++i) {
        z = i == line_.segment[s] ? noise_[i] : line_.q * z + innovation * noise_[i];
        reading_mm[i] = likely_mm[i] + line_.sigma_mm[i] * z + shift[static_cast<Eigen::Index>(i)];
      }
    }
    smoother_.apply(reading_mm, level, simulated_mm);
  }

  [[nodiscard]] const LineSmoother& smoother() const { return smoother_; }
  [[nodiscard]] double seen() const {
    std::vector<double> seen_mm;
    smoother_.apply(likely_mm, level, seen_mm);
    return largest(seen_mm);
  }
  [[nodiscard]] bool isRound() const { return roundness_.has_value(); }
  [[nodiscard]] double roundnessOf(const std::vector<double>& offset_mm) const {
    return roundness_->of(offset_mm);
  }

  LineKind::Rms rms{};
  std::vector<double> estimate_mm;
  std::vector<std::uint8_t> level;
  std::vector<double> likely_mm;
  double noise_share{};    ///< Of the estimates' noise variance that likely_mm still holds.
  double error_squares{};  ///< Expected sum of squares of the readings' errors.
  std::vector<double> reading_mm, simulated_mm;

 private:
  [[nodiscard]] double expectedSquares(LineKind::Rms about) const {
    double sum = 0.0;
    double behind = 0.0;
    double of_sum = 0.0;  // Variance of the sum of all.
    for (std::size_t i = 0; i < line_.size(); ++i) {
      const double s = line_.sigma_mm[i];
      const bool first = std::find(line_.segment.begin(), line_.segment.end(), i) != line_.segment.end();
      behind = first ? 0.0 : behind * line_.q;
      sum += s * s + line_.shared.row(static_cast<Eigen::Index>(i)).squaredNorm();
      of_sum += s * (s + 2.0 * behind);
      behind += s;
    }
    if (about == LineKind::Rms::kAboutZero || line_.size() == 0) return sum;
    return sum - (of_sum + line_.shared.colwise().sum().squaredNorm()) / static_cast<double>(line_.size());
  }

  [[nodiscard]] std::vector<double> likelyTruth() {
    const std::size_t n = line_.size();
    if (n == 0) return {};
    const Eigen::MatrixXd basis = trendBasis(n);
    const Eigen::Map<const Eigen::VectorXd> estimate(estimate_mm.data(), static_cast<Eigen::Index>(n));
    const Eigen::VectorXd trend = basis * basis.colPivHouseholderQr().solve(estimate);
    double by_noise = 0.0;
    for (std::size_t i = 0; i < n; ++i) by_noise += std::pow(smoother_.sigma(i, level[i]), 2);
    const double seen = (estimate - trend).squaredNorm();
    const double share = seen > by_noise ? std::sqrt(1.0 - by_noise / seen) : 0.0;
    noise_share = share * share;
    const Eigen::VectorXd likely = trend + share * (estimate - trend);
    return {likely.begin(), likely.end()};
  }

  /// Standard normal values, two from each pair of uniform ones (Box and Muller).
  static void normals(const CounterRandom& random, std::uint64_t first, std::vector<double>& out) {
    for (std::size_t i = 0; i < out.size(); i += 2) {
      const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform(first + i)));
      const double angle = 2.0 * std::numbers::pi * random.uniform(first + i + 1);
      out[i] = radius * std::cos(angle);
      if (i + 1 < out.size()) out[i + 1] = radius * std::sin(angle);
    }
  }

  const ReadingLine& line_;
  LineSmoother smoother_;
  std::vector<double> noise_;
  std::optional<Roundness> roundness_;
};

/// What the lines show, one number for each: really, in the likely truth, and in each draw.
struct Tally {
  struct Numbers {
    std::vector<double> worst, sum_of_squares;
  };
  Numbers read, truth;
  std::vector<double> seen;         ///< Worst of the likely truth as it is measured without noise.
  std::vector<double> noise_share;  ///< Of the estimates' noise variance that the likely truth still holds.
  std::vector<Numbers> draws;
};

/// Worst and RMS of some of the lines.
class Group {
 public:
  Group(const ErrorModel& model, const std::vector<Simulated>& lines, std::vector<std::size_t> members)
      : members_(std::move(members)) {
    for (const std::size_t l : members_) {
      readings_ += static_cast<double>(model.lines[l].size());
      error_squares_ += lines[l].error_squares;
    }
  }

  [[nodiscard]] DeviationEstimate estimate(const Tally& tally) const {
    DeviationEstimate result;
    if (!(readings_ > 0.0)) return {.worst = {}, .rms = {}, .worst_as_read = kNan};
    std::vector<double> worst;
    std::vector<double> rms;
    for (const Tally::Numbers& draw : tally.draws) {
      worst.push_back(worstOf(draw));
      rms.push_back(rmsOf(draw, error_squares_));
    }
    result.worst_as_read = worstOf(tally.read);
    for (const std::size_t l : members_) {
      if (tally.read.worst[l] == result.worst_as_read) {
        result.line = l;
        break;
      }
    }
    result.worst = basicInterval(result.worst_as_read, worstOf(tally.truth), std::move(worst), 0.0);
    result.worst_u_extreme = hidden(tally, result.line) / std::sqrt(3.0);
    result.worst_u_smoothing = std::abs(seenWorst(tally) - worstOf(tally.truth)) / std::sqrt(3.0);
    result.worst.U = std::hypot(result.worst.U, 2.0 * result.worst_u_extreme, 2.0 * result.worst_u_smoothing);
    result.rms =
        basicInterval(rmsOf(tally.read, error_squares_), rmsOf(tally.truth, 0.0), std::move(rms), 0.0);
    return result;
  }

  /// What the likely truth's worst may owe to the noise that it still holds. Where places compete, the
  /// largest exceeds the truth in proportion to the standard deviation of the noise; a truth that holds a
  /// share h of the variance shows sqrt(1 + h) - sqrt(h) of that, and the rest is hidden. Where one place
  /// stands out nothing is. As that is not known, none of it is taken off, which would make a sheet look
  /// better than it was read, and all of it is counted, as rectangular from 0 (JCGM 100, 4.3.7 and F.2.4.5).
  [[nodiscard]] double hidden(const Tally& tally, std::size_t line) const {
    double mean = 0.0;
    for (const Tally::Numbers& draw : tally.draws)
      mean += worstOf(draw) / static_cast<double>(tally.draws.size());
    const double seen = seenWorst(tally);
    const double h = tally.noise_share[line];
    return (1.0 / (std::sqrt(1.0 + h) - std::sqrt(h)) - 1.0) * std::max(mean - seen, 0.0);
  }
  [[nodiscard]] double seenWorst(const Tally& tally) const {
    double seen = 0.0;
    for (const std::size_t l : members_) seen = std::max(seen, tally.seen[l]);
    return seen;
  }

  [[nodiscard]] double worstOf(const Tally::Numbers& numbers) const {
    double worst = 0.0;
    for (const std::size_t l : members_)
      worst = std::isnan(numbers.worst[l]) ? kNan : std::max(worst, numbers.worst[l]);
    return worst;
  }

 private:
  [[nodiscard]] double rmsOf(const Tally::Numbers& numbers, double errors) const {
    double sum = -errors;
    for (const std::size_t l : members_) sum += numbers.sum_of_squares[l];
    return std::sqrt(std::max(sum, 0.0) / readings_);
  }

  std::vector<std::size_t> members_;
  double readings_{};
  double error_squares_{};
};

/// Shared errors of one draw for the lines of one unit: its pose's own, the camera's common to all.
Eigen::VectorXd drawShared(const ErrorModel& model, int unit, std::uint64_t seed, std::uint64_t draw) {
  const CounterRandom camera(seed, 3 * draw);
  const CounterRandom pose(seed, 3 * draw + 1);
  Eigen::VectorXd e(ReadingLine::kPose + model.modes);
  for (Eigen::Index k = 0; k < e.size(); ++k) {
    const auto index = static_cast<std::uint64_t>(k);
    e[k] = k < ReadingLine::kPose ? pose.normal(index + 3ULL * static_cast<std::uint64_t>(unit))
                                  : camera.normal(index);
  }
  return e;
}

/// Simulates all draws; roundness goes to `round[line]` for circles.
Tally simulate(const ErrorModel& model, std::vector<Simulated>& lines, std::uint64_t seed,
               std::vector<std::vector<double>>& round) {
  Tally tally;
  for (const Simulated& line : lines) {
    tally.read.worst.push_back(largest(line.estimate_mm));
    tally.truth.worst.push_back(largest(line.likely_mm));
    tally.seen.push_back(line.seen());
    tally.noise_share.push_back(line.noise_share);
    tally.truth.sum_of_squares.push_back(sumOfSquares(line.likely_mm, line.rms));
  }
  for (std::size_t l = 0; l < lines.size(); ++l)
    tally.read.sum_of_squares.push_back(sumOfSquares(model.lines[l].reading_mm, lines[l].rms));
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const CounterRandom noise(seed, 3 * draw + 2);
    Tally::Numbers& numbers = tally.draws.emplace_back();
    std::uint64_t first = 0;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      lines[l].measure(noise, first, drawShared(model, model.lines[l].unit, seed, draw));
      first += model.lines[l].size() + 1;
      numbers.worst.push_back(largest(lines[l].simulated_mm));
      numbers.sum_of_squares.push_back(sumOfSquares(lines[l].reading_mm, lines[l].rms));
      if (lines[l].isRound()) round[l].push_back(lines[l].roundnessOf(lines[l].simulated_mm));
    }
  }
  return tally;
}

/// The same without simulation.
ExtremeBudget budgetOf(const ErrorModel& model, const std::vector<Simulated>& lines) {
  std::vector<ExtremePoint> points;
  std::vector<double> seen_mm;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const ReadingLine& line = model.lines[l];
    lines[l].smoother().apply(lines[l].likely_mm, lines[l].level, seen_mm);
    for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
      for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i) {
        const bool first = i == line.segment[s];
        points.push_back(
            {.likely = lines[l].likely_mm[i],
             .seen = seen_mm[i],
             .sigma = lines[l].smoother().sigma(i, lines[l].level[i]),
             .correlation = first ? 0.0 : lines[l].smoother().correlationWithPrevious(i, lines[l].level),
             .shared = line.shared.row(static_cast<Eigen::Index>(i)),
             .group = line.unit});
      }
    }
  }
  return extremeBudget(points, ReadingLine::kPose);
}

UncertaintyBudget describe(const ExtremeBudget& b, const DeviationEstimate& all) {
  UncertaintyBudget out;
  out.quantity = "worst deviation of all lines";
  out.unit = "mm";
  out.as_read = all.worst_as_read;
  out.entries = {
      {"noise and texture at the places that may be the worst, after smoothing", b.u_noise, 0.0},
      {"where the sheet lies, as its printed marks tell", b.u_own, 0.0},
      {"calibration of the camera", b.u_common, 0.0},
      {"smoothing along the line rounds off peaks", all.worst_u_smoothing, b.smoothing_bias},
      {"the largest of many noisy readings is too large on average", all.worst_u_extreme, b.extreme_bias},
  };
  out.analytic_U = 2.0 * std::hypot(std::hypot(b.u_noise, b.u_own, b.u_common), all.worst_u_extreme,
                                    all.worst_u_smoothing);
  out.analytic_value = std::max(all.worst_as_read - b.smoothing_bias - out.entries.back().correction, 0.0);
  out.monte_carlo_U = all.worst.U;
  out.monte_carlo_value = all.worst.value;
  out.draws = kDraws;
  return out;
}

std::size_t placeOfLargest(const std::vector<double>& values) {
  const auto at = std::max_element(values.begin(), values.end(),
                                   [](double a, double b) { return std::abs(a) < std::abs(b); });
  return static_cast<std::size_t>(at - values.begin());
}

}  // namespace

DeviationResult measureDeviations(const ErrorModel& model, const std::vector<LineKind>& kinds,
                                  double limit_mm, std::uint64_t seed) {
  std::vector<Simulated> lines;
  lines.reserve(model.lines.size());
  for (std::size_t l = 0; l < model.lines.size(); ++l) lines.emplace_back(model.lines[l], kinds[l]);
  std::vector<std::vector<double>> round(lines.size());
  const Tally tally = simulate(model, lines, seed, round);

  DeviationResult result;
  const auto estimateOf = [&](std::vector<std::size_t> members) {
    DeviationEstimate e = Group(model, lines, std::move(members)).estimate(tally);
    if (!lines.empty() && !lines[e.line].estimate_mm.empty())
      e.reading = placeOfLargest(lines[e.line].estimate_mm);
    return e;
  };
  std::vector<std::size_t> everything;
  std::vector<std::vector<std::size_t>> of_layer;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    everything.push_back(l);
    result.lines.push_back(estimateOf({l}));
    const auto known = std::find(result.layer_names.begin(), result.layer_names.end(), kinds[l].layer);
    if (known == result.layer_names.end()) {
      result.layer_names.push_back(kinds[l].layer);
      of_layer.push_back({l});
    } else {
      of_layer[static_cast<std::size_t>(known - result.layer_names.begin())].push_back(l);
    }
    result.circularity.push_back(lines[l].isRound()
                                     ? basicInterval(lines[l].roundnessOf(lines[l].estimate_mm),
                                                     lines[l].roundnessOf(lines[l].likely_mm), round[l], 0.0)
                                     : Quantity{});
  }
  for (auto& members : of_layer) result.layers.push_back(estimateOf(std::move(members)));
  const Group all(model, lines, everything);
  result.all = estimateOf(everything);
  std::vector<double> worst;
  for (const Tally::Numbers& draw : tally.draws) worst.push_back(all.worstOf(draw));
  result.chance_beyond = std::isfinite(result.all.worst.U) ? chanceAbove(limit_mm, result.all.worst_as_read,
                                                                         all.worstOf(tally.truth), worst)
                                                           : kNan;
  if (std::isfinite(result.all.worst.U)) result.budget = describe(budgetOf(model, lines), result.all);
  return result;
}

}  // namespace kerfbench::hil
