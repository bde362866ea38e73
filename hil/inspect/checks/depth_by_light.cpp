// SPDX-License-Identifier: Apache-2.0
// How deep creases and half-cuts are, by the light that comes through: evenly all along, and as ordered.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// A single caliper tells depth to 1 % of itself, by the grid of pixels more than by their noise.
constexpr double kBlock_mm = 1.0;
constexpr std::size_t kBlocks = 5;  // Blocks of one look at the depth: to 0.2 %.
/// From a free end on: there the kerf is round, and no power could mend it. The beam that stops at an end
/// leaves (1 + erf(sqrt 2 x / w)) / 2 of its energy at x from it: all but 0.4 % at x = w, which is 0.105 mm,
/// and a caliper takes in 0.1 mm on either side. On short-lines, in the mean of two seeds, calipers are 20,
/// 12, 0.6 and less than 0.2 % too shallow at 0, 0.1, 0.2 and 0.3 mm from the start, 16, 10, 0.4 and 0.5 % at
/// the end, where one alone scatters by 1.1 %. Wang, Li, Chen 2010 except the start point too. What a loop on
/// the power does until it has measured is judged: 0.5 % deeper over 2 mm there.
constexpr double kEnd_mm = 0.3;

struct Reading {
  double share{};       ///< Depth over the board's thickness.
  double station_mm{};  ///< Along the chain.
  const vision::Caliper* caliper{};
};

/// How far what the groove's depth is told by may be off what is stated, as shares (k = 2): the board's
/// transmission, the beam's radius, and how far the lens mixes the light.
constexpr double kTransmissionU = 0.1;
constexpr double kRadiusU = 0.1;
constexpr double kMiddleU = 0.1;
/// What the groove's model leaves of a millimetre's depth (k = 2): on coupon-perforated with 20, 30, 40, 50
/// and 60 % of the power the block farthest from the truth is 3.1, 1.9, 1.3, 1.3 and 1.8 % of the board off.
constexpr double kModelU = 0.03;

/// A groove that a round beam leaves, and how its light is read.
struct Groove {
  double transmission{};
  double beam_radius_mm{};   ///< 1/e²
  double middle_sigma_mm{};  ///< EntityKerf::middle_sigma_mm
};

/// Entities of one process that go on where the one before ends.
struct Chain {
  double middle_sigma_mm{};
  int unit{};
  int entity{};  ///< First entity of the chain.
  dieline::Process process{};
  double length_mm{};
  std::vector<Reading> readings;
};

/// Mean over a millimetre. Blocks of one row follow each other without a gap.
struct Block {
  double share{};
  const vision::Caliper* middle{};
};
struct Row {
  const Chain* chain{};
  std::vector<Block> blocks;
};

/// Depth by Beer's law over the board that is left: open (board / open)^(1 - depth).
double depthOf(double brightness, double transmission) {
  return 1.0 - std::log(transmission + brightness * (1.0 - transmission)) / std::log(transmission);
}

/// The brightness from which depthOf() has a depth.
double brightnessOf(double depth, double transmission) {
  return (std::pow(transmission, 1.0 - depth) - transmission) / (1.0 - transmission);
}

std::vector<Chain> chainsOf(const Evidence& evidence, double transmission) {
  std::vector<Chain> chains;
  const dieline::Curve* before = nullptr;
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    const dieline::Entity& entity = evidence.dieline->entities[static_cast<std::size_t>(kerf.entity)];
    if (entity.process != dieline::Process::kCrease && entity.process != dieline::Process::kHalfCut) continue;
    const bool goes_on =
        before != nullptr && chains.back().unit == kerf.unit && chains.back().process == entity.process &&
        (dieline::pointAt(*before, 1.0) - dieline::pointAt(entity.curve, 0.0)).norm() <= kMeet_mm;
    if (!goes_on) chains.push_back({kerf.middle_sigma_mm, kerf.unit, kerf.entity, entity.process, 0.0, {}});
    Chain& chain = chains.back();
    for (const vision::Caliper& c : kerf.calipers) {
      if (judgesOffset(c))
        chain.readings.push_back({depthOf(c.brightness, transmission), chain.length_mm + c.station_mm, &c});
    }
    chain.length_mm += dieline::lengthOf(entity.curve);
    before = &entity.curve;
  }
  for (Chain& chain : chains) {
    std::erase_if(chain.readings, [&](const Reading& r) {
      return r.station_mm < kEnd_mm || r.station_mm > chain.length_mm - kEnd_mm;
    });
  }
  return chains;
}

std::vector<Row> rowsOf(const std::vector<Chain>& chains) {
  std::vector<Row> rows;
  for (const Chain& chain : chains) {
    const auto& r = chain.readings;
    for (std::size_t first = 0; first < r.size();) {
      const double begin_mm = r[first].station_mm;
      std::size_t end = first;
      double sum = 0.0;
      while (end < r.size() && r[end].station_mm < begin_mm + kBlock_mm) sum += r[end++].share;
      const bool gap = first == 0 || begin_mm - r[first - 1].station_mm > 0.5 * kBlock_mm;
      const bool part = r[end - 1].station_mm - begin_mm < 0.5 * kBlock_mm;
      if (gap || part) rows.push_back({&chain, {}});
      if (!part)
        rows.back().blocks.push_back({sum / static_cast<double>(end - first), r[(first + end) / 2].caliper});
      first = end;
    }
  }
  return rows;
}

/// Standard uncertainty of a block, from second differences: what varies slowly is depth. Their median, which
/// places that are too deep hardly raise.
double sigmaOf(const std::vector<Row>& rows) {
  std::vector<double> squares;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 2 < row.blocks.size(); ++i) {
      const double d = row.blocks[i].share - 2.0 * row.blocks[i + 1].share + row.blocks[i + 2].share;
      squares.push_back(d * d / 6.0);
    }
  }
  return std::sqrt(medianOf(std::move(squares)) / kMedianSquare);
}

/// Length over which the depth at a point is told.
constexpr double kPoint_mm = 2.0;

/// Depth at a point of a line; NaN where no caliper is.
struct PointDepth {
  double share{kNan};
  const vision::Caliper* nearest{};
};

/// Depths at points of a chain, at equal distances, from its start on.
std::vector<PointDepth> pointsOf(const Chain& chain, int count) {
  std::vector<PointDepth> points;
  for (int i = 0; i < count; ++i) {
    const double at_mm = chain.length_mm * i / count;
    PointDepth point;
    double sum = 0.0;
    int readings = 0;
    for (const Reading& reading : chain.readings) {
      if (std::abs(reading.station_mm - at_mm) > 0.5 * kPoint_mm) continue;
      if (readings == 0 || reading.station_mm <= at_mm) point.nearest = reading.caliper;
      sum += reading.share;
      ++readings;
    }
    if (readings > 0) point.share = sum / readings;
    points.push_back(point);
  }
  return points;
}

Groove grooveOf(const Chain& chain, const Evidence& evidence, const Tolerances& limits) {
  return {limits.board_transmission, evidence.beam_radius_mm, chain.middle_sigma_mm};
}

/// Light, over that through an open kerf, that the middle of a groove shows, which the lens has mixed with
/// that of its flanks. Depth goes with fluence.
double lightOf(const Groove& groove, double depth) {
  constexpr int kSamples = 24;
  constexpr double kSigmas = 3.5;
  double sum = 0.0;
  double weight = 0.0;
  for (int i = -kSamples; i <= kSamples; ++i) {
    const double z = kSigmas * i / kSamples;
    const double a = z * groove.middle_sigma_mm / groove.beam_radius_mm;
    const double w = std::exp(-0.5 * z * z);
    sum += w * std::pow(groove.transmission, 1.0 - depth * std::exp(-2.0 * a * a));
    weight += w;
  }
  return sum / weight;
}

/// Depth in the middle of a groove by its brightness, by bisection.
double grooveDepth(const Groove& groove, double brightness) {
  const double light = groove.transmission + brightness * (1.0 - groove.transmission);
  double low = 0.0;
  double high = 2.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (lightOf(groove, middle) < light ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// What is not known of the groove does to its depth (k = 2).
double grooveU(const Groove& groove, double brightness) {
  const auto half = [&](double Groove::*what, double share) {
    Groove more = groove;
    Groove less = groove;
    more.*what *= 1.0 + share;
    less.*what *= 1.0 - share;
    return 0.5 * std::abs(grooveDepth(more, brightness) - grooveDepth(less, brightness));
  };
  return std::hypot(half(&Groove::transmission, kTransmissionU), half(&Groove::beam_radius_mm, kRadiusU),
                    half(&Groove::middle_sigma_mm, kMiddleU));
}

}  // namespace

const Tolerances::OrderedDepth* orderOf(dieline::Process process, const Tolerances& limits) {
  const Tolerances::OrderedDepth& order =
      process == dieline::Process::kCrease ? limits.crease_depth : limits.half_cut_depth;
  return order.most > 0.0 ? &order : nullptr;
}

Finding orderedDepthCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{
      .name = "ordered_depth", .title = "Creases and half-cuts are as deep as ordered", .unit = "share"};
  check.upper = false;
  check.value = kNan;
  const std::vector<Chain> chains = chainsOf(evidence, limits.board_transmission);
  const bool ordered = std::ranges::any_of(
      chains, [&](const Chain& chain) { return orderOf(chain.process, limits) != nullptr; });
  if (!ordered) {
    return notApplicable(check,
                         "The scenario orders no depth (checks.crease_depth, checks.half_cut_depth) of "
                         "a process that the dieline has.");
  }
  if (!(evidence.beam_radius_mm > 0.0))
    return notJudged(check, "Without the beam's radius the light of a groove does not tell how deep it is.");
  const std::vector<Row> rows = rowsOf(chains);
  const double noise = sigmaOf(rows);
  const Row* worst = nullptr;
  const Block* worst_block = nullptr;
  double depth = kNan;
  for (const Row& row : rows) {
    const Tolerances::OrderedDepth* order = orderOf(row.chain->process, limits);
    if (order == nullptr) continue;
    const Groove groove = grooveOf(*row.chain, evidence, limits);
    for (const Block& block : row.blocks) {
      const double share = grooveDepth(groove, brightnessOf(block.share, groove.transmission));
      const double margin = std::min(share - order->least, order->most - share);
      if (margin >= check.value) continue;
      check.value = margin;
      depth = share;
      worst = &row;
      worst_block = &block;
    }
  }
  if (worst == nullptr) return notJudged(check, "No crease or half-cut is long enough to tell its depth.");
  const Groove groove = grooveOf(*worst->chain, evidence, limits);
  check.u = check.guard = std::hypot(std::hypot(2.0 * noise, kModelU),
                                     grooveU(groove, brightnessOf(worst_block->share, groove.transmission)));
  decide(check);
  const Tolerances::OrderedDepth& order = *orderOf(worst->chain->process, limits);
  check.subject = nameOf(worst->chain->unit, worst->chain->entity);
  check.where = atPlace(worst->chain->unit, worst->chain->entity, worst_block->middle->p_S_mm);
  check.explanation = fmt::format(
      "Nearest to the bounds, or farthest beyond, is the {} at {}: {:.1f} ± {:.1f} % of the board deep in "
      "its "
      "middle, over {:g} mm; ordered are {:g} to {:g} %. The value is the margin to the nearer bound.",
      dieline::processName(worst->chain->process), placeOf(worst_block->middle->p_S_mm), 100.0 * depth,
      100.0 * check.u, kBlock_mm, 100.0 * order.least, 100.0 * order.most);
  return check;
}

namespace {

/// What even_depth says of the points that were asked for.
class Points {
 public:
  Points(const std::vector<Chain>& chains, const Evidence& evidence, const Tolerances& limits)
      : evidence_(evidence), limits_(limits) {
    if (limits.depth_points <= 0) return;
    chain_ = &*std::ranges::max_element(chains, {}, &Chain::length_mm);
    points_ = pointsOf(*chain_, limits.depth_points);
    std::vector<double> shares;
    for (std::size_t i = 1; i < points_.size(); ++i)
      if (points_[i].nearest != nullptr) shares.push_back(points_[i].share);
    if (!shares.empty()) usual_ = medianOf(std::move(shares));
  }

  [[nodiscard]] std::size_t count() const { return points_.size(); }
  /// Adds all but the start; a point without a reading makes the extreme unknown.
  void addTo(ExtremeEstimate& extreme, double sigma_of_1_mm) const {
    for (std::size_t i = 1; i < points_.size(); ++i)
      extreme.add(points_[i].share / usual_ - 1.0, sigma_of_1_mm / std::sqrt(kPoint_mm) / usual_);
  }
  [[nodiscard]] std::string text(double sigma_of_1_mm) const {
    if (points_.empty()) return {};
    double worst = 0.0;
    std::string depths;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i > 0 && !(std::abs(points_[i].share / usual_ - 1.0) <= worst))
        worst = std::abs(points_[i].share / usual_ - 1.0);
      depths += fmt::format(" {:.4f}", depth_mm(points_[i].share));
    }
    return fmt::format(
        " Depths at {} points of {}, from its start on, {:.3g} mm apart, in mm:{}. But for the start they "
        "are "
        "within {:.2f} % of their median, each known to {:.2f} %.",
        points_.size(), nameOf(chain_->unit, chain_->entity), chain_->length_mm / limits_.depth_points,
        depths, 100.0 * worst, 200.0 * sigma_of_1_mm / std::sqrt(kPoint_mm) / usual_);
  }

 private:
  [[nodiscard]] double depth_mm(double share) const {
    const Groove groove = grooveOf(*chain_, evidence_, limits_);
    const bool is_groove = groove.beam_radius_mm > 0.0 && std::isfinite(share);
    return limits_.board_thickness_mm *
           (is_groove ? grooveDepth(groove, brightnessOf(share, groove.transmission)) : share);
  }

  const Evidence& evidence_;
  const Tolerances& limits_;
  const Chain* chain_{};
  std::vector<PointDepth> points_;
  double usual_{kNan};
};

}  // namespace

Finding evenDepthCheck(const Evidence& evidence, const Tolerances& limits) {
  Check check{.name = "even_depth", .title = "Creases and half-cuts are as deep everywhere", .unit = "share"};
  if (!(limits.even_depth_share > 0.0))
    return notApplicable(check, "The scenario does not order it (checks.even_depth_share).");
  const std::vector<Chain> chains = chainsOf(evidence, limits.board_transmission);
  if (chains.empty()) return notApplicable(check, "The dieline has no crease and no half-cut.");
  check.limit = limits.even_depth_share;
  const std::vector<Row> rows = rowsOf(chains);
  const double sigma = sigmaOf(rows) / std::sqrt(static_cast<double>(kBlocks));
  std::map<dieline::Process, std::vector<double>> shares;
  std::size_t windows = 0;
  for (const Row& row : rows) {
    for (const Block& block : row.blocks) shares[row.chain->process].push_back(block.share);
    windows += row.blocks.size() < kBlocks ? 0 : row.blocks.size() - kBlocks + 1;
  }
  std::map<dieline::Process, double> usual;
  for (const auto& [process, values] : shares) usual[process] = medianOf(values);
  const Points points(chains, evidence, limits);
  ExtremeEstimate extreme(windows + points.count());
  const Row* worst = nullptr;
  const Block* worst_block = nullptr;
  double worst_change = 0.0;
  for (const Row& row : rows) {
    const double as_usual = usual[row.chain->process];
    for (std::size_t i = 0; i + kBlocks <= row.blocks.size(); ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kBlocks; ++k) sum += row.blocks[i + k].share;
      const double change = sum / kBlocks / as_usual - 1.0;
      extreme.add(change, sigma / as_usual);
      if (worst != nullptr && std::abs(change) <= std::abs(worst_change)) continue;
      worst = &row;
      worst_block = &row.blocks[i + kBlocks / 2];
      worst_change = change;
    }
  }
  points.addTo(extreme, sigmaOf(rows));
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  decide(check);
  if (worst == nullptr) {
    check.explanation = "No crease or half-cut is long enough to tell how even its depth is.";
    return check;
  }
  check.subject = nameOf(worst->chain->unit, worst->chain->entity);
  check.where = atPlace(worst->chain->unit, worst->chain->entity, worst_block->middle->p_S_mm);
  check.explanation = fmt::format(
      "Of {} stretches of {:g} mm the one at {} is off the most: {:.2f} % {} than is usual for its process "
      "({}, about {:.0f} % of the board); the first and last {:g} mm of a line are left out. The light tells "
      "changes of depth better than depth itself.",
      windows, kBlock_mm * kBlocks, placeOf(worst_block->middle->p_S_mm), 100.0 * std::abs(worst_change),
      worst_change > 0.0 ? "deeper" : "shallower", dieline::processName(worst->chain->process),
      100.0 * usual[worst->chain->process], kEnd_mm);
  check.explanation += points.text(sigmaOf(rows));
  return check;
}

}  // namespace kerfbench::inspect::checks
