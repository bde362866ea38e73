// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/worst_deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
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
constexpr std::size_t kLinesAtOnce = 256;  // Draws of so many lines are kept: 16 kB each.
constexpr std::uint64_t kStreams = 4;      // Streams of random numbers, for each draw.
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

/// What one line shows: as it was read, in the likely truth, and in that as it is measured without noise.
struct LineFigures {
  struct Shown {
    double worst{}, sum_of_squares{};
  };
  double readings{};
  double error_squares{};
  Shown read, truth;
  double seen{};                  ///< Worst without noise.
  std::size_t worst_reading{};    ///< Where it is read.
  double error{}, error_share{};  ///< SimulatedLine::errorAt() and errorShareAt() of that reading.
};

/// The same of each draw of a line, or of many lines together.
struct Draw {
  double worst{}, sum_of_squares{};
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

/// Worst and RMS of some of the lines. These are announced first, and then added in the same order, each with
/// its draws: of many lines nobody keeps them all.
class Group {
 public:
  Group(const ErrorModel& model, const std::vector<LineFigures>& lines)
      : lines_(lines), estimator_mm_(model.estimator_mm), trends_(model.trends) {}

  void announce(std::size_t line) {
    members_.push_back(line);
    readings_ += lines_[line].readings;
    error_squares_ += lines_[line].error_squares;
  }
  void add(const std::vector<Draw>& draws) {
    if (draws_.empty()) draws_.assign(kDraws, {0.0, -error_squares_});
    for (std::size_t d = 0; d < kDraws; ++d) {
      draws_[d].worst = std::isnan(draws[d].worst) ? kNan : std::max(draws_[d].worst, draws[d].worst);
      draws_[d].sum_of_squares += draws[d].sum_of_squares;
    }
  }

  [[nodiscard]] DeviationEstimate estimate(std::uint64_t seed) const {
    DeviationEstimate result;
    if (!(readings_ > 0.0)) return {.worst = {}, .rms = {}, .worst_as_read = kNan};
    result.worst_as_read = worstOf(&LineFigures::read);
    for (const std::size_t l : members_) {
      if (lines_[l].read.worst == result.worst_as_read) {
        result.line = l;
        break;
      }
    }
    const LineFigures& worst = lines_[result.line];
    result.reading = worst.worst_reading;
    result.worst_hidden = hiddenOf(worst.error_share, drawnWorst(), seenWorst());
    result.worst_u_smoothing = std::abs(seenWorst() - worstOf(&LineFigures::truth)) / std::sqrt(3.0);
    result.worst_u_competing = competingOf(meanOf(drawnWorst()) - seenWorst());
    const Quantity drawn = basicInterval(result.worst_as_read, worstOf(&LineFigures::truth),
                                         drawnWorst(result.worst_hidden, seed), -kInfinity);
    const double more_mm = std::hypot(result.worst_u_smoothing, result.worst_u_competing, estimator_mm_);
    if (!trends_) result.worst_u_place = worst.error;
    result.worst =
        magnitude(drawn.value, std::hypot(std::max(drawn.U, 2.0 * result.worst_u_place), 2.0 * more_mm));
    std::vector<double> rms;
    for (const Draw& draw : draws_) rms.push_back(rmsOf(draw.sum_of_squares));
    result.rms = basicInterval(rmsOf(squaresOf(&LineFigures::read, error_squares_)),
                               rmsOf(squaresOf(&LineFigures::truth, 0.0)), rms, 0.0);
    return result;
  }

  [[nodiscard]] double chanceAbove(double limit_mm, const DeviationEstimate& e, std::uint64_t seed) const {
    if (!std::isfinite(e.worst.U)) return kNan;
    return inspect::chanceAbove(limit_mm, e.worst_as_read, worstOf(&LineFigures::truth),
                                drawnWorst(e.worst_hidden, seed));
  }

 private:
  [[nodiscard]] std::vector<double> drawnWorst() const {
    std::vector<double> worst;
    for (const Draw& draw : draws_) worst.push_back(draw.worst);
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
    for (const std::size_t l : members_) seen = std::max(seen, lines_[l].seen);
    return seen;
  }

  [[nodiscard]] double worstOf(LineFigures::Shown LineFigures::*shown) const {
    double worst = 0.0;
    for (const std::size_t l : members_)
      worst = std::isnan((lines_[l].*shown).worst) ? kNan : std::max(worst, (lines_[l].*shown).worst);
    return worst;
  }
  [[nodiscard]] double squaresOf(LineFigures::Shown LineFigures::*shown, double errors) const {
    double sum = -errors;
    for (const std::size_t l : members_) sum += (lines_[l].*shown).sum_of_squares;
    return sum;
  }
  [[nodiscard]] double rmsOf(double squares) const { return std::sqrt(std::max(squares, 0.0) / readings_); }

  std::vector<std::size_t> members_;
  const std::vector<LineFigures>& lines_;
  std::vector<Draw> draws_;
  double readings_{};
  double error_squares_{};
  double estimator_mm_;
  bool trends_;
};

/// Simulated measurements of all lines that are made together.
class Batch {
 public:
  Batch(const ErrorModel& model, std::uint64_t seed, std::uint64_t first_draw)
      : first_draw_(first_draw),
        own_(streams(seed, kOwnErrors)),
        pose_(streams(seed, kPoseErrors)),
        shared_(streams(seed, kCameraErrors)),
        noise_(streams(seed, kNoise)) {
    for (Eigen::Index k = model.tiles; k < model.modes; ++k)
      camera_.push_back(normalsOf(shared_, static_cast<std::uint64_t>(k)));
  }

  /// Measures a line; its first reading takes the noise at counter `first`.
  void measure(const ReadingLine& line, const SimulatedLine& simulated, std::size_t number,
               std::uint64_t first, SimulatedReadings& into) const {
    std::vector<Draws> shared;
    for (const Eigen::Index column : simulated.columns()) shared.push_back(errorOf(column, line, number));
    simulated.measure(noise_, first, shared, into);
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
  [[nodiscard]] Draws errorOf(Eigen::Index column, const ReadingLine& line, std::size_t number) const {
    const auto k = static_cast<std::uint64_t>(column);
    if (column < ReadingLine::kLine)
      return normalsOf(own_, static_cast<std::uint64_t>(ReadingLine::kLine) * number + k);
    const auto unit = static_cast<std::uint64_t>(line.unit);
    if (column < ReadingLine::kOwn) return normalsOf(pose_, 3 * unit + k - ReadingLine::kLine);
    const Eigen::Index behind_own = column - ReadingLine::kOwn;
    if (behind_own < line.tileColumns())
      return normalsOf(shared_, static_cast<std::uint64_t>(line.tiles[static_cast<std::size_t>(behind_own)]));
    return camera_[static_cast<std::size_t>(behind_own - line.tileColumns())];
  }

  std::uint64_t first_draw_;
  Generators own_, pose_, shared_, noise_;
  std::vector<Draws> camera_;  ///< Errors behind those of the tiles, which all lines have.
};

/// The range about the least-squares circle is an extreme as well.
Quantity circularityOf(const Roundness& round, std::vector<double> drawn, std::uint64_t seed) {
  const double hidden_mm = hiddenOf(round.noiseShare(), drawn, round.likely());
  const double competing_mm = competingOf(meanOf(drawn) - round.likely());
  addHidden(hidden_mm, seed, drawn);
  const Quantity range = basicInterval(round.asRead(), round.likely(), drawn, 0.0);
  const double more_mm = std::hypot(round.unfittedSigma(), round.seamSigma(), competing_mm);
  return magnitude(range.value, std::hypot(range.U, 2.0 * more_mm));
}

/// What a line shows in one tile moves apart from what it shows in the next, so that each such part competes
/// on its own to be the worst.
std::vector<ExtremeLine> partsOf(const ReadingLine& line, const SimulatedLine& simulated) {
  const std::vector<double> seen_mm = simulated.seen();
  std::vector<ExtremeLine> parts{{line.unit, line.tiles, {}}};
  for (std::size_t s = 0; s + 1 < line.segment.size(); ++s) {
    for (std::size_t i = line.segment[s]; i < line.segment[s + 1]; ++i) {
      const bool next_tile = i > 0 && !line.sameTile(i, i - 1);
      if (next_tile) parts.push_back({line.unit, line.tiles, {}});
      const bool first = i == line.segment[s] || next_tile;
      parts.back().points.push_back(
          {.likely = simulated.likely_mm[i],
           .seen = seen_mm[i],
           .sigma = simulated.smoother().sigma(i, simulated.level[i]),
           .correlation = first ? 0.0 : simulated.smoother().correlationWithPrevious(i, simulated.level),
           .shared = line.shared.row(static_cast<Eigen::Index>(i))});
    }
  }
  return parts;
}

/// Simulates the lines one at a time, each with all its draws: what one takes is a kilobyte for each reading,
/// and a long run has millions. Lines share nothing but what is drawn for all of them.
class Simulation {
 public:
  Simulation(const ErrorModel& model, const std::vector<LineKind>& kinds, std::uint64_t seed, int threads)
      : model_(model),
        kinds_(kinds),
        seed_(seed),
        threads_(threads),
        figures_(model.size()),
        heights_(model.size()),
        first_(model.size() + 1, 0) {
    static_assert(kDraws % kDrawsAtOnce == 0);
    for (std::size_t begin = 0; begin < kDraws; begin += kDrawsAtOnce)
      batches_.emplace_back(model, seed, begin);
    base::forEachIndex(figures_.size(), threads, [&](std::size_t l) {
      const ReadingLine line = model_.line(l);
      figures_[l].readings = static_cast<double>(line.size());
      figures_[l].error_squares = errorSquaresOf(line);
      first_[l + 1] = line.size() + 1;
    });
    for (std::size_t l = 0; l < figures_.size(); ++l) first_[l + 1] += first_[l];
  }

  [[nodiscard]] const std::vector<LineFigures>& figures() const { return figures_; }

  /// Fills lines and circularity of the result, and hands the draws of each line on, line by line.
  void run(const std::function<void(std::size_t line, const std::vector<Draw>& draws)>& drawn,
           DeviationResult& result) {
    result.lines.resize(figures_.size());
    result.circularity.resize(figures_.size());
    for (std::size_t begin = 0; begin < figures_.size(); begin += kLinesAtOnce) {
      const std::size_t count = std::min(kLinesAtOnce, figures_.size() - begin);
      std::vector<std::vector<Draw>> draws(count);
      base::forEachIndex(count, threads_, [&](std::size_t i) { draws[i] = simulate(begin + i, result); });
      for (std::size_t i = 0; i < count; ++i) drawn(begin + i, draws[i]);
    }
  }

  /// The uncertainty of the worst of all lines without simulation.
  [[nodiscard]] ExtremeBudget budget() const {
    const auto parts = [&](std::size_t l) {
      const ReadingLine line = model_.line(l);
      return partsOf(line, SimulatedLine(line, kinds_[l], kernels_));
    };
    return extremeBudget(heights_, parts, model_.tiles, threads_);
  }

 private:
  std::vector<Draw> simulate(std::size_t l, DeviationResult& result) {
    const ReadingLine line = model_.line(l);
    const SimulatedLine simulated(line, kinds_[l], kernels_);
    look(line, simulated, l);
    std::vector<Draw> draws;
    std::vector<double> round;
    SimulatedReadings readings;
    for (const Batch& batch : batches_) {
      batch.measure(line, simulated, l, first_[l], readings);
      const Draws worst = largestOf(readings.simulated_mm);
      const Draws squares = sumOfSquares(readings.reading_mm, simulated.rms);
      for (std::size_t d = 0; d < kDrawsAtOnce; ++d) draws.push_back({worst[d], squares[d]});
      if (!simulated.roundness()) continue;
      const Draws ranges = batch.rangesOf(simulated, l, seed_, readings);
      round.insert(round.end(), ranges.begin(), ranges.end());
    }
    Group alone(model_, figures_);
    alone.announce(l);
    alone.add(draws);
    result.lines[l] = alone.estimate(seed_);
    if (simulated.roundness())
      result.circularity[l] = circularityOf(*simulated.roundness(), std::move(round), seed_);
    return draws;
  }

  /// What there is to know of a line besides its draws.
  void look(const ReadingLine& line, const SimulatedLine& simulated, std::size_t l) {
    LineFigures& figures = figures_[l];
    figures.read = {largestOf(simulated.estimate_mm), sumOfSquares(line.reading_mm, simulated.rms)};
    figures.truth = {largestOf(simulated.likely_mm), sumOfSquares(simulated.likely_mm, simulated.rms)};
    figures.seen = largestOf(simulated.seen());
    if (line.size() > 0) {
      figures.worst_reading = placeOfLargest(simulated.estimate_mm);
      figures.error = simulated.errorAt(figures.worst_reading);
      figures.error_share = simulated.errorShareAt(figures.worst_reading);
    }
    for (const ExtremeLine& part : partsOf(line, simulated)) heights_[l].add(part);
  }

  const ErrorModel& model_;
  const std::vector<LineKind>& kinds_;
  std::uint64_t seed_;
  int threads_;
  std::shared_ptr<LineSmoother::Kernels> kernels_{std::make_shared<LineSmoother::Kernels>()};
  std::vector<Batch> batches_;
  std::vector<LineFigures> figures_;
  std::vector<ExtremeHeights> heights_;
  std::vector<std::uint64_t> first_;  ///< Counter of each line's noise.
};

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
  Simulation simulation(model, kinds, seed, threads);
  DeviationResult result;
  Group all(model, simulation.figures());
  std::vector<Group> layers;
  std::vector<std::size_t> layer_of;
  for (std::size_t l = 0; l < model.size(); ++l) {
    const auto known = std::find(result.layer_names.begin(), result.layer_names.end(), kinds[l].layer);
    layer_of.push_back(static_cast<std::size_t>(known - result.layer_names.begin()));
    if (known == result.layer_names.end()) {
      result.layer_names.push_back(kinds[l].layer);
      layers.emplace_back(model, simulation.figures());
    }
    all.announce(l);
    layers[layer_of.back()].announce(l);
  }
  simulation.run(
      [&](std::size_t line, const std::vector<Draw>& draws) {
        all.add(draws);
        layers[layer_of[line]].add(draws);
      },
      result);
  for (const Group& layer : layers) result.layers.push_back(layer.estimate(seed));
  result.all = all.estimate(seed);
  result.chance_beyond = all.chanceAbove(limit_mm, result.all, seed);
  if (std::isfinite(result.all.worst.U))
    result.budget = describe(simulation.budget(), result.all, model.estimator_mm);
  return result;
}

}  // namespace kerfbench::inspect
