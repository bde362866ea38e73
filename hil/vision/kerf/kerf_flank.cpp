// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_flank.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include <Eigen/Core>

#include "hil/vision/kerf/flank_belief.h"
#include "hil/vision/kerf/kerf_blur.h"
#include "hil/vision/kerf/kerf_sampling.h"
#include "hil/vision/kerf/light_law.h"

namespace kerfbench::vision {
namespace {

constexpr double kBarelyOpen = 0.9;

}  // namespace

bool isOpen(const FlankQuery& seen) { return !(seen.top_gray < kBarelyOpen * seen.open_gray); }

namespace {

constexpr int kGridPerPx = 8;
constexpr int kFlankTopSamples = 24;
constexpr double kReachPx = 7.0;   // Reach of the profile beyond half a kerf.
constexpr double kSmoothMm = 1.0;  // Half length of the mean along the curve.
constexpr double kIndependentMm = 0.2;
// Share of the picture's blur, for scorch alone: with all of it no one kModelShare fits both narrow and wide
// scorch.
constexpr double kScorchBlur = 0.93;
constexpr double kModelShare = 0.4;  // Share of the shift that the model of scorch leaves.
/// The same for a groove: its floor is scorched as well, which the model does not have.
constexpr double kShallowShare = 1.2;
/// Least difference of the sides over the board's light; less is lost in noise.
constexpr double kLeastOdd = 0.05;
constexpr double kTightBend_per_mm = 1.4;
constexpr double kTightModel_mm = 0.001;
constexpr double kWidestMm = 0.6;
constexpr double kBendMm = 0.3;  // Distance of the readings by which the bend of a kerf is measured.

/// A profile over y >= 0, blurred, between two samples as on a straight line.
double at(BlurredProfile& f, double index) {
  const double clamped = std::clamp(index, 0.0, static_cast<double>(f.size()) - 1.001);
  const auto i = static_cast<std::size_t>(clamped);
  const double t = clamped - static_cast<double>(i);
  return (1.0 - t) * f[i] + t * f[i + 1];
}

/// Blurs a function given on y >= 0 and mirrored with a sign to y < 0.
BlurredProfile blurred(const std::vector<double>& f, double sign, const BlurKernel& kernel) {
  return {f.size(), kernel, [&](int at) {
            if (at == 0 && sign < 0.0) return 0.0;
            const auto i = std::min(static_cast<std::size_t>(std::abs(at)), f.size() - 1);
            return (at < 0 ? sign : 1.0) * f[i];
          }};
}

/// Fluence of a beam over y, over that in its middle.
double beamAt(const FlankQuery& q, double y_mm) {
  const double a = y_mm / q.beam_radius_mm;
  return std::exp(-2.0 * a * a);
}
/// Share of the cutting fluence over y of a hard edge.
double hardShareAt(const FlankQuery& q, double peak, double y_mm) {
  return y_mm < q.half_width_mm ? std::min(peak, 1.0) : 0.0;
}

double middleSigma_mm(const FlankQuery& q) {
  return std::hypot(q.lens_px, kPeakPx / std::numbers::sqrt3) * q.pixel_mm;
}

/// Light that the pixels in the middle of a kerf show, which the lens has mixed with that of its flanks.
class SeenTop {
 public:
  explicit SeenTop(const FlankQuery& q) : open_gray_(q.open_gray) {
    const double sigma_mm = middleSigma_mm(q);
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      const double z = kReach * static_cast<double>(i) / kFlankTopSamples;
      weights_[i] = std::exp(-0.5 * z * z);
      shares_[i] = beamAt(q, z * sigma_mm);
    }
  }
  [[nodiscard]] double at(double peak, const LightLaw& law) const {
    std::array<double, kFlankTopSamples + 1> light{};
    for (std::size_t i = 0; i < light.size(); ++i)
      light[i] = open_gray_ * law.lightAt(std::min(1.0, peak * shares_[i]));
    double sum = 0.0;
    double weight = 0.0;
    for (int side = -kFlankTopSamples; side <= kFlankTopSamples; ++side) {
      const auto i = static_cast<std::size_t>(std::abs(side));
      sum += weights_[i] * light[i];
      weight += weights_[i];
    }
    return sum / weight;
  }

 private:
  static constexpr double kReach = 3.5;  ///< Standard deviations of the blur.
  double open_gray_;
  std::array<double, kFlankTopSamples + 1> weights_{};
  std::array<double, kFlankTopSamples + 1> shares_{};  ///< Shares of the fluence, over that at the peak.
};

double peakShare(const FlankQuery& q, const LightLaw& law) {
  const auto shareOf = [&](double gray) { return law.shareAt(std::min(gray, q.open_gray) / q.open_gray); };
  if (!isOpen(q)) {
    double low = std::max(0.0, shareOf(q.top_gray));
    if (!(q.beam_radius_mm > 0.0)) return low;
    const SeenTop seen(q);
    double high = 1.0;
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (low + high);
      (seen.at(middle, law) < q.top_gray ? low : high) = middle;
    }
    return low;
  }
  if (!(q.beam_radius_mm > 0.0)) return 1.0;
  const double a = q.half_width_mm / q.beam_radius_mm;
  return std::max(1.0, shareOf(0.5 * (q.top_gray + q.board_gray)) * std::exp(2.0 * a * a));
}

LightLaw lawOf(const FlankQuery& q) { return {std::clamp(q.board_gray / q.open_gray, 1e-3, 0.9), q.growth}; }

/// Light of flanks that differ by width and depth alone, at a fixed step over y >= 0.
class FlankLight {
 public:
  explicit FlankLight(const FlankQuery& q)
      : step_mm_(q.pixel_mm / kGridPerPx), law_(lawOf(q)), kernel_(kernelOf(q)) {}

  [[nodiscard]] double step_mm() const { return step_mm_; }
  [[nodiscard]] const LightLaw& law() const { return law_; }
  [[nodiscard]] const BlurKernel& kernel() const { return kernel_; }
  /// Without blur; `left_too` gets the light of the board that is left.
  [[nodiscard]] std::vector<double> at(const FlankQuery& q, double peak, std::vector<double>* left_too) {
    const auto n = static_cast<std::size_t>((q.half_width_mm + kReachPx * q.pixel_mm) / step_mm_) + 2;
    std::vector<double> light;
    light.reserve(n);
    if (left_too != nullptr) left_too->reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double share = shareAt(q, peak, i);
      light.push_back(q.open_gray * law_.lightAt(share));
      if (left_too != nullptr) left_too->push_back(share >= 1.0 ? 0.0 : light.back());
    }
    return light;
  }

 private:
  static BlurKernel kernelOf(const FlankQuery& q) {
    const double sigma = std::hypot(q.lens_px, kSplinePx) * kGridPerPx;
    return {sigma, static_cast<int>(std::ceil(4.0 * sigma))};
  }
  double shareAt(const FlankQuery& q, double peak, std::size_t i) {
    const auto y_mm = [&](std::size_t k) { return static_cast<double>(k) * step_mm_; };
    if (!(q.beam_radius_mm > 0.0)) return hardShareAt(q, peak, y_mm(i));
    while (beam_.size() <= i) beam_.push_back(beamAt(q, y_mm(beam_.size())));
    return peak * beam_[i];
  }

  double step_mm_;
  LightLaw law_;
  BlurKernel kernel_;
  std::vector<double> beam_;  ///< Fluence over that of the peak.
};

/// Where a profile that falls from its middle outwards is down to a level.
template <typename Profile>
double halfWidthAt(Profile& profile, double level, double step_mm) {
  std::size_t i = 1;
  while (i + 1 < profile.size() && profile[i] > level) ++i;
  const double fall = profile[i - 1] - profile[i];
  const double share = fall > 0.0 ? std::clamp((profile[i - 1] - level) / fall, 0.0, 1.0) : 1.0;
  return (static_cast<double>(i) - 1.0 + share) * step_mm;
}

}  // namespace

// The query's own half width is that of the picture, at half of the brightness seen in its middle; the
// model's is changed until its picture is as wide.
FlankFall fallOf(const FlankQuery& seen) {
  FlankQuery query = seen;
  const auto levelAt = [&](double share) {
    return query.board_gray + share * (query.top_gray - query.board_gray);
  };
  FlankLight flank(seen);
  FlankFall fall{seen.half_width_mm, seen.half_width_mm, seen.half_width_mm, seen.half_width_mm};
  double peak = 0.0;
  for (int i = 0; i < 4; ++i) {
    // How deep a shallow one is does not depend on its width.
    if (i == 0 || isOpen(query)) peak = peakShare(query, flank.law());
    const std::vector<double> light = flank.at(query, peak, nullptr);
    BlurredProfile even = blurred(light, 1.0, flank.kernel());
    fall.light_mm = halfWidthAt(light, 0.5 * (light.front() + query.board_gray), flank.step_mm());
    fall.low_mm = halfWidthAt(even, levelAt(0.25), flank.step_mm());
    fall.high_mm = halfWidthAt(even, levelAt(0.75), flank.step_mm());
    fall.half_mm = halfWidthAt(even, levelAt(0.5), flank.step_mm());
    const double error_mm = fall.half_mm - seen.half_width_mm;
    query.half_width_mm = std::max(query.half_width_mm - error_mm, 0.2 * query.pixel_mm);
  }
  return fall;
}

FlankModel::FlankModel(const FlankQuery& query) {
  const bool sane = query.board_gray > 0.5 && query.open_gray > 1.2 * query.board_gray &&
                    query.top_gray > 1.1 * query.board_gray && query.half_width_mm > 0.2 * query.pixel_mm &&
                    query.half_width_mm < kWidestMm;
  if (!sane) return;
  FlankQuery scorched = query;
  scorched.lens_px *= kScorchBlur;
  FlankLight flank(scorched);
  const double step_mm = flank.step_mm();
  std::vector<double> left;
  const std::vector<double> light = flank.at(scorched, peakShare(scorched, flank.law()), &left);
  BlurredProfile even = blurred(light, 1.0, flank.kernel());
  const auto evenSlope = [&](double y_mm) {
    return (at(even, y_mm / step_mm + 1.0) - at(even, y_mm / step_mm - 1.0)) / (2.0 * step_mm);
  };
  // Where the blurred profile is half way down.
  const double level = 0.5 * (even[0] + query.board_gray);
  std::size_t half = 1;
  while (half + 2 < even.size() && even[half] > level) ++half;
  const double f_mm = static_cast<double>(half) * step_mm;
  const double slope = evenSlope(f_mm);
  if (!(slope < 0.0)) return;
  // Scorch that takes a share k more on the left than on the right: half of that each way.
  BlurredProfile burnt = blurred(left, -1.0, flank.kernel());
  const auto asymmetry = [&](double y_mm) { return -0.5 * at(burnt, y_mm / step_mm); };
  const double shift_mm = -asymmetry(f_mm) / slope;
  const double beside_mm = f_mm + kBesidePx * query.pixel_mm;
  const double odd_gray = 2.0 * (asymmetry(beside_mm) + shift_mm * evenSlope(beside_mm));
  if (std::abs(odd_gray) > kLeastOdd * query.board_gray) gain_mm_ = shift_mm / odd_gray;
  widening_mm_ = 2.0 * (query.half_width_mm - fallOf(query).light_mm);
}

namespace {

/// Stations whose readings show what scorch does to the flanks.
bool showsFlanks(const EntityPlan& plan, const EntityKerf& kerf, const std::vector<KerfReading>& readings,
                 std::size_t i) {
  const Caliper& c = kerf.calipers[i];
  return c.found && !c.near_joint && plan.stations[i].hidden_count == 0 &&
         std::isfinite(readings[i].odd_gray);
}

/// Light, beam and blur of a view on a kerf.
FlankQuery viewedBy(const FlankView& view, FlankQuery query) {
  query.growth = view.growth;
  query.beam_radius_mm = view.beam_radius_mm;
  query.lens_px = view.lens_px;
  query.open_gray *= view.open;
  return query;
}

/// Running sums of 1, odd gray, and its square, over the stations that show it; one more than stations.
std::vector<Eigen::Vector3d> oddSums(const EntityPlan& plan, const std::vector<KerfReading>& readings,
                                     const EntityKerf& kerf) {
  std::vector<Eigen::Vector3d> sums(1, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
    sums.push_back(sums.back());
    if (!showsFlanks(plan, kerf, readings, i)) continue;
    const double odd = readings[i].odd_gray;
    sums.back() += Eigen::Vector3d(1.0, odd, odd * odd);
  }
  return sums;
}

}  // namespace

SeenFlank meanFlank(const EntityPlan& plan, const std::vector<KerfReading>& readings,
                    const FlankOptics& optics, const EntityKerf& kerf) {
  SeenFlank mean{.query = {.open_gray = optics.options.open_gray,
                           .beam_radius_mm = optics.options.beam_radius_mm,
                           .pixel_mm = optics.pixel_mm,
                           .lens_px = optics.blur.px},
                 .is_crease = plan.process == dieline::Process::kCrease};
  FlankQuery& query = mean.query;
  double count = 0.0;
  for (std::size_t i = 0; i < kerf.calipers.size(); ++i) {
    // A kerf that is as narrow as the blur may not have all levels.
    const bool falls = std::isfinite(readings[i].low_width_mm) && std::isfinite(readings[i].high_width_mm);
    if (!falls || !showsFlanks(plan, kerf, readings, i)) continue;
    count += 1.0;
    query.half_width_mm += 0.5 * readings[i].width_mm;
    query.top_gray += readings[i].top_gray;
    query.board_gray += readings[i].base_gray;
    mean.low_half_mm += 0.5 * readings[i].low_width_mm;
    mean.high_half_mm += 0.5 * readings[i].high_width_mm;
  }
  for (double* value :
       {&query.half_width_mm, &query.top_gray, &query.board_gray, &mean.low_half_mm, &mean.high_half_mm})
    *value /= std::max(1.0, count);
  return mean;
}

void correctFlankBias(const EntityPlan& plan, const std::vector<KerfReading>& readings,
                      const FlankOptics& optics, const FlankBelief& belief, EntityKerf& kerf,
                      std::vector<double>& model_mm) {
  const std::size_t n = kerf.calipers.size();
  model_mm.assign(n, 0.0);
  const FlankQuery mean = meanFlank(plan, readings, optics, kerf).query;
  const FlankModel model(mean);
  const FlankMoments widening =
      belief.momentsOf([&](const FlankView& view) { return FlankModel(viewedBy(view, mean)).widening_mm(); });
  kerf.widening_mm = widening.likely;
  kerf.widening_sigma_mm = widening.sigma;
  kerf.middle_sigma_mm = middleSigma_mm(mean);
  const double model_share = isOpen(mean) ? kModelShare : kShallowShare;

  const std::vector<Eigen::Vector3d> sums = oddSums(plan, readings, kerf);
  const double pitch_mm = n > 1 ? plan.length_mm / static_cast<double>(n - 1) : 1.0;
  const auto reach = static_cast<std::size_t>(kSmoothMm / pitch_mm);
  for (std::size_t i = 0; i < n; ++i) {
    Caliper& c = kerf.calipers[i];
    if (!c.found) continue;
    const std::size_t from = i - std::min(i, reach);
    const std::size_t to = std::min(n, i + reach + 1);
    const Eigen::Vector3d sum = sums[to] - sums[from];
    const double odd_gray = sum.x() > 0.0 ? sum.y() / sum.x() : 0.0;
    const double variance = sum.x() > 0.0 ? std::max(0.0, sum.z() / sum.x() - odd_gray * odd_gray) : 0.0;
    // Readings a window and a grain apart are independent.
    const double independent = std::max(1.0, sum.x() * std::min(1.0, pitch_mm / kIndependentMm));
    double scorch_mm = model.shiftMm(odd_gray);
    model_mm[i] = std::hypot(model_share * scorch_mm, model.shiftMm(std::sqrt(variance / independent)));
    const double bend_per_mm = plan.stations[i].curvature_per_mm;
    if (std::abs(bend_per_mm) > kTightBend_per_mm) {
      // The kerf of a small hole is no mirror image of itself without any scorch.
      scorch_mm = 0.0;
      model_mm[i] = kTightModel_mm;
    }
    // The lens draws both edges of a curve towards its centre.
    const double lens_mm = optics.blur.px * optics.pixel_mm;
    c.offset_mm -= scorch_mm + 0.5 * lens_mm * lens_mm * bend_per_mm;
    c.width_mm -= kerf.widening_mm;
  }
}

void correctCurvatureBias(const EntityPlan& plan, double lens_mm, EntityKerf& kerf) {
  const std::size_t n = kerf.calipers.size();
  if (n < 2) return;
  const double pitch_mm = plan.length_mm / static_cast<double>(n - 1);
  const auto apart = static_cast<std::size_t>(std::max(1.0, std::round(kBendMm / pitch_mm)));
  const double apart_mm = static_cast<double>(apart) * pitch_mm;
  if (apart_mm > 2.0 * kBendMm) return;  // Too far apart to measure a bend.
  const auto offsetAt = [&](std::size_t i) {
    const Caliper& c = kerf.calipers[i];
    return c.found && !c.near_joint ? c.offset_mm : std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<double> taken_mm(n, 0.0);
  // A closed curve goes on past its first station, which is its last.
  const std::size_t round = n - 1;
  for (std::size_t i = 0; i < n; ++i) {
    const bool inside = i >= apart && i + apart < n;
    if (!inside && !(plan.closed && round > 2 * apart)) continue;
    const std::size_t before = inside ? i - apart : (i + round - apart) % round;
    const std::size_t after = inside ? i + apart : (i + apart) % round;
    const double second = offsetAt(before) - 2.0 * offsetAt(i) + offsetAt(after);
    if (!std::isfinite(second)) continue;
    const double window_mm = 2.0 * kWindowHalfMm;
    taken_mm[i] = (window_mm * window_mm / 24.0 + 0.5 * lens_mm * lens_mm) * second / (apart_mm * apart_mm);
  }
  for (std::size_t i = 0; i < n; ++i) kerf.calipers[i].offset_mm -= taken_mm[i];
}

}  // namespace kerfbench::vision
