// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/worst_deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/inspect/deviation/extreme_budget.h"
#include "hil/inspect/deviation/simulated_line.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kDraws = 1000;
constexpr std::size_t kBatchesAtOnce = 25;  // What is drawn for all lines is kept for so many.
constexpr std::uint64_t kStreams = 4;       // Streams of random numbers, for each draw.
constexpr std::uint64_t kHiddenStream = kStreams * kDraws;
constexpr std::uint64_t kRoundStream =
    kHiddenStream + 1;  // First stream of the circles; each draw of each line takes one from here on.

/// A magnitude below nought is impossible: the interval ends there.
Quantity magnitude(double value, double U) {
  const double low = std::max(value - U, 0.0);
  const double high = std::max(value + U, low);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

std::size_t placeOfLargest(const std::vector<double>& values) {
  const auto at = std::max_element(values.begin(), values.end(),
                                   [](double a, double b) { return std::abs(a) < std::abs(b); });
  return static_cast<std::size_t>(at - values.begin());
}

/// What the lines show, one number for each: really, in the likely truth, and in each draw.
struct Tally {
  struct Numbers {
    std::vector<double> worst, sum_of_squares;
  };
  Numbers read, truth;
  std::vector<double> seen;  ///< Worst of the likely truth as it is measured without noise.
  std::vector<Numbers> draws;
};

double meanOf(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  return mean;
}

/// The most that an extreme of the likely truth may owe to the errors that it still holds. Where places
/// compete, the largest exceeds the truth in proportion to the standard deviation of the errors; a truth that
/// holds a share h of their variance shows sqrt(1 + h) - sqrt(h) of that, and the rest is hidden. Where one
/// place stands out nothing is.
double hiddenOf(double h, const std::vector<double>& drawn, double seen) {
  return (1.0 / (std::sqrt(1.0 + h) - std::sqrt(h)) - 1.0) * std::max(meanOf(drawn) - seen, 0.0);
}

/// Standard uncertainty of the correction for being an extreme. Whether places compete as the likely truth
/// has it cannot be read from one measurement: its errors may have parted them, or brought them together. It
/// is taken as rectangular from nothing to twice as much (JCGM 100, 4.3.7).
double competingOf(double correction) { return std::abs(correction) / std::sqrt(3.0); }

/// How many places compete cannot be read: what is hidden is taken as rectangular from nothing to all
/// (JCGM 100, 4.3.7).
void addHidden(double hidden, std::uint64_t seed, std::vector<double>& drawn) {
  const CounterRandom share(seed, kHiddenStream);
  for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i] += hidden * share.uniform(i);
}

/// Worst and RMS of some of the lines.
class Group {
 public:
  Group(const ErrorModel& model, const std::vector<SimulatedLine>& lines, std::vector<std::size_t> members,
        const Tally& tally)
      : members_(std::move(members)),
        lines_(lines),
        tally_(tally),
        estimator_mm_(model.estimator_mm),
        trends_(model.trends) {
    for (const std::size_t l : members_) {
      readings_ += static_cast<double>(model.lines[l].size());
      error_squares_ += lines[l].error_squares;
    }
  }

  [[nodiscard]] DeviationEstimate estimate(std::uint64_t seed) const {
    DeviationEstimate result;
    if (!(readings_ > 0.0)) return {.worst = {}, .rms = {}, .worst_as_read = kNan};
    result.worst_as_read = worstOf(tally_.read);
    for (const std::size_t l : members_) {
      if (tally_.read.worst[l] == result.worst_as_read) {
        result.line = l;
        break;
      }
    }
    result.reading = placeOfLargest(lines_[result.line].estimate_mm);
    result.worst_hidden =
        hiddenOf(lines_[result.line].errorShareAt(result.reading), drawnWorst(), seenWorst());
    result.worst_u_smoothing = std::abs(seenWorst() - worstOf(tally_.truth)) / std::sqrt(3.0);
    result.worst_u_competing = competingOf(meanOf(drawnWorst()) - seenWorst());
    const Quantity drawn = basicInterval(result.worst_as_read, worstOf(tally_.truth),
                                         drawnWorst(result.worst_hidden, seed), -kInfinity);
    const double more_mm = std::hypot(result.worst_u_smoothing, result.worst_u_competing, estimator_mm_);
    if (!trends_) result.worst_u_place = lines_[result.line].errorAt(result.reading);
    result.worst =
        magnitude(drawn.value, std::hypot(std::max(drawn.U, 2.0 * result.worst_u_place), 2.0 * more_mm));
    std::vector<double> rms;
    for (const Tally::Numbers& draw : tally_.draws) rms.push_back(rmsOf(draw, error_squares_));
    result.rms = basicInterval(rmsOf(tally_.read, error_squares_), rmsOf(tally_.truth, 0.0), rms, 0.0);
    return result;
  }

  [[nodiscard]] double chanceAbove(double limit_mm, const DeviationEstimate& e, std::uint64_t seed) const {
    if (!std::isfinite(e.worst.U)) return kNan;
    return inspect::chanceAbove(limit_mm, e.worst_as_read, worstOf(tally_.truth),
                                drawnWorst(e.worst_hidden, seed));
  }

 private:
  [[nodiscard]] std::vector<double> drawnWorst() const {
    std::vector<double> worst;
    for (const Tally::Numbers& draw : tally_.draws) worst.push_back(worstOf(draw));
    return worst;
  }
  /// With a share of what is hidden.
  [[nodiscard]] std::vector<double> drawnWorst(double hidden_mm, std::uint64_t seed) const {
    std::vector<double> worst = drawnWorst();
    addHidden(hidden_mm, seed, worst);
    return worst;
  }
  [[nodiscard]] double seenWorst() const {
    double seen = 0.0;
    for (const std::size_t l : members_) seen = std::max(seen, tally_.seen[l]);
    return seen;
  }

  [[nodiscard]] double worstOf(const Tally::Numbers& numbers) const {
    double worst = 0.0;
    for (const std::size_t l : members_)
      worst = std::isnan(numbers.worst[l]) ? kNan : std::max(worst, numbers.worst[l]);
    return worst;
  }
  [[nodiscard]] double rmsOf(const Tally::Numbers& numbers, double errors) const {
    double sum = -errors;
    for (const std::size_t l : members_) sum += numbers.sum_of_squares[l];
    return std::sqrt(std::max(sum, 0.0) / readings_);
  }

  std::vector<std::size_t> members_;
  const std::vector<SimulatedLine>& lines_;
  const Tally& tally_;
  double readings_{};
  double error_squares_{};
  double estimator_mm_;
  bool trends_;
};

/// Simulated measurements of all lines that are made together.
class Batch {
 public:
  Batch(const ErrorModel& model, std::uint64_t seed, std::uint64_t first_draw)
      : model_(model),
        first_draw_(first_draw),
        own_(streams(seed, kOwnErrors)),
        pose_(streams(seed, kPoseErrors)),
        noise_(streams(seed, kNoise)) {
    camera_.resize(static_cast<std::size_t>(model.modes));
    const auto camera = streams(seed, kCameraErrors);
    for (std::size_t k = 0; k < camera_.size(); ++k) camera_[k] = normalsOf(camera, k);
  }

  /// Measures a line; its first reading takes the noise at counter `first`.
  void measure(const SimulatedLine& line, std::size_t number, std::uint64_t first,
               SimulatedReadings& into) const {
    std::vector<Draws> shared;
    for (const Eigen::Index column : line.columns()) shared.push_back(errorOf(column, number));
    line.measure(noise_, first, shared, into);
  }

  [[nodiscard]] Draws rangesOf(const SimulatedLine& circle, std::size_t number, std::uint64_t seed,
                               const SimulatedReadings& readings) const {
    return circle.roundness()->simulated(generators([&](std::uint64_t d) {
                                           return CounterRandom(
                                               seed, kRoundStream + kDraws * number + first_draw_ + d);
                                         }),
                                         readings.shift_mm);
  }

 private:
  using Generators = std::array<CounterRandom, kDrawsAtOnce>;
  enum Stream : std::uint64_t { kOwnErrors, kPoseErrors, kCameraErrors, kNoise };

  template <typename Make>
  static Generators generators(const Make& make) {
    return [&]<std::size_t... d>(std::index_sequence<d...>) { return Generators{make(d)...}; }
    (std::make_index_sequence<kDrawsAtOnce>());
  }
  [[nodiscard]] Generators streams(std::uint64_t seed, Stream stream) const {
    return generators(
        [&](std::uint64_t d) { return CounterRandom(seed, kStreams * (first_draw_ + d) + stream); });
  }
  static Draws normalsOf(const Generators& random, std::uint64_t index) {
    Draws values{};
    for (std::size_t d = 0; d < values.size(); ++d) values[d] = random[d].normal(index);
    return values;
  }
  /// Error of a column of ReadingLine::shared: the line's own, its unit's pose, tiles and camera.
  [[nodiscard]] Draws errorOf(Eigen::Index column, std::size_t line) const {
    const auto k = static_cast<std::uint64_t>(column);
    if (column < ReadingLine::kLine)
      return normalsOf(own_, static_cast<std::uint64_t>(ReadingLine::kLine) * line + k);
    const auto unit = static_cast<std::uint64_t>(model_.lines[line].unit);
    if (column < ReadingLine::kOwn) return normalsOf(pose_, 3 * unit + k - ReadingLine::kLine);
    const Eigen::Index behind_own = column - ReadingLine::kOwn;
    const std::vector<Eigen::Index>& tiles = model_.lines[line].tiles;
    const Eigen::Index place = behind_own < model_.lines[line].tileColumns()
                                   ? tiles[static_cast<std::size_t>(behind_own)]
                                   : behind_own - model_.lines[line].tileColumns() + model_.tiles;
    return camera_[static_cast<std::size_t>(place)];
  }

  const ErrorModel& model_;
  std::uint64_t first_draw_;
  Generators own_, pose_, noise_;
  std::vector<Draws> camera_;
};

std::vector<SimulatedLine> simulatedLines(const ErrorModel& model, const std::vector<LineKind>& kinds,
                                          int threads) {
  const auto kernels = std::make_shared<LineSmoother::Kernels>();
  std::vector<std::optional<SimulatedLine>> made(model.lines.size());
  base::forEachIndex(made.size(), threads,
                     [&](std::size_t l) { made[l].emplace(model.lines[l], kinds[l], kernels); });
  std::vector<SimulatedLine> lines;
  lines.reserve(made.size());
  for (std::optional<SimulatedLine>& line : made) lines.push_back(std::move(*line));
  return lines;
}

/// What the lines show really and in the likely truth, with room for the draws.
Tally tallyOf(const ErrorModel& model, const std::vector<SimulatedLine>& lines) {
  Tally tally;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    tally.read.worst.push_back(largestOf(lines[l].estimate_mm));
    tally.read.sum_of_squares.push_back(sumOfSquares(model.lines[l].reading_mm, lines[l].rms));
    tally.truth.worst.push_back(largestOf(lines[l].likely_mm));
    tally.truth.sum_of_squares.push_back(sumOfSquares(lines[l].likely_mm, lines[l].rms));
    tally.seen.push_back(largestOf(lines[l].seen()));
  }
  const std::vector<double> room(lines.size());
  tally.draws.assign(kDraws, {room, room});
  return tally;
}

/// Simulates all draws; roundness goes to `round[line]` for circles. Lines share nothing but what was drawn
/// for all of them.
void simulate(const ErrorModel& model, const std::vector<SimulatedLine>& lines, std::uint64_t seed,
              int threads, Tally& tally, std::vector<std::vector<double>>& round) {
  static_assert(kDraws % (kDrawsAtOnce * kBatchesAtOnce) == 0);
  std::vector<std::uint64_t> first(lines.size() + 1, 0);
  for (std::size_t l = 0; l < lines.size(); ++l) first[l + 1] = first[l] + model.lines[l].size() + 1;
  for (std::size_t begin = 0; begin < kDraws; begin += kDrawsAtOnce * kBatchesAtOnce) {
    std::vector<Batch> batches;
    for (std::size_t b = 0; b < kBatchesAtOnce; ++b)
      batches.emplace_back(model, seed, begin + b * kDrawsAtOnce);
    base::forEachIndex(lines.size(), threads, [&](std::size_t l) {
      SimulatedReadings readings;
      std::size_t draw = begin;
      for (const Batch& batch : batches) {
        batch.measure(lines[l], l, first[l], readings);
        const Draws worst = largestOf(readings.simulated_mm);
        const Draws squares = sumOfSquares(readings.reading_mm, lines[l].rms);
        for (std::size_t d = 0; d < kDrawsAtOnce; ++d, ++draw) {
          tally.draws[draw].worst[l] = worst[d];
          tally.draws[draw].sum_of_squares[l] = squares[d];
        }
        if (!lines[l].roundness()) continue;
        const Draws ranges = batch.rangesOf(lines[l], l, seed, readings);
        round[l].insert(round[l].end(), ranges.begin(), ranges.end());
      }
    });
  }
}

/// The range about the least-squares circle is an extreme as well.
Quantity circularityOf(const Roundness& round, std::vector<double> drawn, std::uint64_t seed) {
  const double hidden_mm = hiddenOf(round.noiseShare(), drawn, round.likely());
  const double competing_mm = competingOf(meanOf(drawn) - round.likely());
  addHidden(hidden_mm, seed, drawn);
  const Quantity range = basicInterval(round.asRead(), round.likely(), drawn, 0.0);
  const double more_mm = std::hypot(round.unfittedSigma(), round.seamSigma(), competing_mm);
  return magnitude(range.value, std::hypot(range.U, 2.0 * more_mm));
}

/// The same without simulation. What a line shows in one tile moves apart from what it shows in the next, so
/// that each such part competes on its own.
ExtremeBudget budgetOf(const ErrorModel& model, const std::vector<SimulatedLine>& lines, int threads) {
  std::vector<ExtremeLine> extremes;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const ReadingLine& line = model.lines[l];
    const SimulatedLine& simulated = lines[l];
    const std::vector<double> seen_mm = simulated.seen();
    extremes.push_back({line.unit, line.tiles, {}});
    for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
      for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i) {
        const bool next_tile = i > 0 && !line.sameTile(i, i - 1);
        if (next_tile) extremes.push_back({line.unit, line.tiles, {}});
        const bool first = i == line.segment[s] || next_tile;
        extremes.back().points.push_back(
            {.likely = simulated.likely_mm[i],
             .seen = seen_mm[i],
             .sigma = simulated.smoother().sigma(i, simulated.level[i]),
             .correlation = first ? 0.0 : simulated.smoother().correlationWithPrevious(i, simulated.level),
             .shared = line.shared.row(static_cast<Eigen::Index>(i))});
      }
    }
  }
  return extremeBudget(extremes, model.tiles, threads);
}

UncertaintyBudget describe(const ExtremeBudget& b, const DeviationEstimate& all, double estimator_mm) {
  const double hidden = all.worst_hidden / std::sqrt(12.0);
  const double spread =
      std::hypot(std::hypot(b.u_noise, b.u_pose), std::hypot(b.u_table, b.u_camera), hidden);
  const double lacking = std::sqrt(std::max(all.worst_u_place * all.worst_u_place - spread * spread, 0.0));
  UncertaintyBudget out;
  out.quantity = "worst deviation of all lines";
  out.unit = "mm";
  out.as_read = all.worst_as_read;
  out.entries = {
      {"noise, texture and grid of pixels at the places that may be the worst", b.u_noise, b.extreme_bias},
      {"where the sheet lies, as its printed marks tell", b.u_pose, 0.0},
      {"where the inspection table stopped", b.u_table, 0.0},
      {"calibration of the camera", b.u_camera, 0.0},
      {"smoothing along the line rounds off peaks", all.worst_u_smoothing, b.smoothing_bias},
      {"the largest of many noisy readings is too large, by how much is not known",
       std::hypot(hidden, competingOf(b.extreme_bias), lacking), 0.5 * all.worst_hidden},
      {"what the estimator leaves, as artefacts of known deviation show", estimator_mm, 0.0},
  };
  double variance = 0.0;
  out.analytic_value = all.worst_as_read;
  for (const BudgetEntry& entry : out.entries) {
    variance += entry.u * entry.u;
    out.analytic_value -= entry.correction;
  }
  const Quantity analytic = magnitude(out.analytic_value, 2.0 * std::sqrt(variance));
  out.analytic_value = analytic.value;
  out.analytic_U = analytic.U;
  out.monte_carlo_U = all.worst.U;
  out.monte_carlo_value = all.worst.value;
  out.draws = kDraws;
  return out;
}

}  // namespace

DeviationResult measureDeviations(const ErrorModel& model, const std::vector<LineKind>& kinds,
                                  double limit_mm, std::uint64_t seed, int threads) {
  std::vector<SimulatedLine> lines = simulatedLines(model, kinds, threads);
  std::vector<std::vector<double>> round(lines.size());
  Tally tally = tallyOf(model, lines);
  simulate(model, lines, seed, threads, tally, round);

  DeviationResult result;
  result.lines.resize(lines.size());
  result.circularity.resize(lines.size());
  base::forEachIndex(lines.size(), threads, [&](std::size_t l) {
    result.lines[l] = Group(model, lines, {l}, tally).estimate(seed);
    if (lines[l].roundness())
      result.circularity[l] = circularityOf(*lines[l].roundness(), std::move(round[l]), seed);
  });
  std::vector<std::size_t> everything;
  std::vector<std::vector<std::size_t>> of_layer;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    everything.push_back(l);
    const auto known = std::find(result.layer_names.begin(), result.layer_names.end(), kinds[l].layer);
    if (known == result.layer_names.end()) {
      result.layer_names.push_back(kinds[l].layer);
      of_layer.push_back({l});
    } else {
      of_layer[static_cast<std::size_t>(known - result.layer_names.begin())].push_back(l);
    }
  }
  for (auto& members : of_layer)
    result.layers.push_back(Group(model, lines, std::move(members), tally).estimate(seed));
  const Group all(model, lines, everything, tally);
  result.all = all.estimate(seed);
  result.chance_beyond = all.chanceAbove(limit_mm, result.all, seed);
  if (std::isfinite(result.all.worst.U))
    result.budget = describe(budgetOf(model, lines, threads), result.all, model.estimator_mm);
  return result;
}

}  // namespace kerfbench::inspect
