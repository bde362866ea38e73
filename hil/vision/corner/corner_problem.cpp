// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_problem.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::vision {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Standard deviations of prior knowledge.
constexpr double kSlopeSigma = 0.2;
// Prior of the difference of both overruns, which hardly shows in a picture as long as they are small: it is
// about as large as their sum, or this. Neither leg stops short where the other one overruns.
constexpr double kUneven_mm = 0.005;
constexpr double kOpposite_mm = 0.003;
constexpr double kPeakSigma = 1.0;  // Standard deviation of the logarithm of a peak.
/// Standard deviation of the board, gray.
constexpr double kBoardSigma = 10.0;
constexpr double kOpenSigma = 4.0;  // Standard deviation of open kerf, gray.
/// Standard deviation of the blur, as no lens blurs quite by a Gaussian.
constexpr double kBlurShapePx = 0.02;
/// Standard deviation of scorch, which the calipers correct for (FlankModel).
constexpr double kScorchSigma_mm = 0.0025;
constexpr double kLengthStep_mm = 5e-4;  // Step of differences by lengths.
constexpr double kGrayStep = 0.2;
constexpr double kOtherStep = 2e-3;
constexpr double kDarkShare = 0.1;  // Share of the way from board to open kerf.
constexpr double kLeastNoise_gray2 = 0.09;

}  // namespace

void setEnds(double together_mm, double more_in_mm, CornerShape& shape) {
  shape.in.over_mm = 0.5 * (together_mm + more_in_mm);
  shape.out.over_mm = 0.5 * (together_mm - more_in_mm);
}

VectorXd parametersOf(const CornerShape& shape, const CornerLight& light, Meeting meeting) {
  VectorXd x(kMeet + (meeting == Meeting::kArc ? 1 : 2));
  x.head(kMeet) << shape.in.offset_mm, shape.in.slope, shape.in.curvature_per_mm, shape.in.twist_per_mm2,
      shape.out.offset_mm, shape.out.slope, shape.out.curvature_per_mm, shape.out.twist_per_mm2,
      std::log(light.peak_in), std::log(light.peak_out), std::log(light.beam_radius_mm), light.board_gray,
      light.open_gray, light.blur_px, light.scorch_in_mm, light.scorch_out_mm, light.growth.law,
      light.growth.begin;
  if (meeting == Meeting::kArc) {
    x[kMeet] = shape.rounding_mm;
  } else {
    x.tail<2>() << shape.in.over_mm + shape.out.over_mm, shape.in.over_mm - shape.out.over_mm;
  }
  return x;
}

CornerShape shapeOf(const VectorXd& x, CornerShape shape) {
  const auto setLeg = [&](CornerLeg& leg, Index first) {
    leg.offset_mm = x[first];
    leg.slope = x[first + 1];
    leg.curvature_per_mm = x[first + 2];
    leg.twist_per_mm2 = x[first + 3];
    leg.over_mm = 0.0;
  };
  setLeg(shape.in, kInOffset);
  setLeg(shape.out, kOutOffset);
  shape.rounding_mm = 0.0;
  if (x.size() == kMeet + 1) {
    shape.rounding_mm = x[kMeet];
  } else {
    setEnds(x[kMeet], x[kMeet + 1], shape);
  }
  return shape;
}

CornerLight lightOf(const VectorXd& x) {
  return {std::exp(std::min(x[kPeakIn], 5.0)),
          std::exp(std::min(x[kPeakOut], 5.0)),
          std::exp(x[kRadius]),
          std::max(1.0, x[kBoard]),
          std::max(2.0, x[kOpen]),
          {std::clamp(x[kLaw], -2.5, 2.5), std::clamp(x[kBegin], 0.0, 0.85)},
          x[kBlur],
          x[kInScorch],
          x[kOutScorch]};
}

CornerProblem::CornerProblem(const CornerPicture& picture, const CornerKnown& known)
    : picture_(picture), known_(known), model_(picture.grid, picture.counts, known.legs.front()) {
  for (std::size_t i = 0; i < picture.counts.size(); ++i) {
    if (picture.counts[i]) used_.push_back(i);
  }
}

void CornerProblem::setNoiseFrom(const VectorXd& x) {
  model_.render(shapeOf(x, known_.legs.front()), lightOf(x), gray_);
  const double border_gray = x[kBoard] + kDarkShare * (x[kOpen] - x[kBoard]);
  double count[2]{}, mean[2]{}, square[2]{};
  for (const std::size_t at : used_) {
    const std::size_t bright = gray_[at] > border_gray ? 1 : 0;
    const double rest = picture_.gray[at] - gray_[at];
    count[bright] += 1.0;
    mean[bright] += gray_[at];
    square[bright] += rest * rest;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    mean[i] /= std::max(1.0, count[i]);
    square[i] /= std::max(1.0, count[i]);
  }
  const double slope =
      count[0] > 0.0 && count[1] > 0.0 ? std::max(0.0, (square[1] - square[0]) / (mean[1] - mean[0])) : 0.0;
  const double dark = count[0] > 0.0 ? square[0] : square[1];
  for (std::size_t i = 0; i < used_.size(); ++i)
    noise_gray_[i] = std::sqrt(std::max(kLeastNoise_gray2, dark + slope * (gray_[used_[i]] - mean[0])));
}

int CornerProblem::operator()(const VectorXd& x, VectorXd& f) const {
  const Index n = pixels();
  const CornerShape shape = shapeOf(x, known_.legs.front());
  const CornerLight& light = known_.light;
  model_.render(shape, lightOf(x), gray_);
  for (Index i = 0; i < n; ++i) {
    const std::size_t at = used_[static_cast<std::size_t>(i)];
    f[i] = (gray_[at] - picture_.gray[at]) / noise_gray_[static_cast<std::size_t>(i)];
  }
  Index next = n;
  const auto hold = [&](const CornerLeg& leg, const KnownLeg& known) {
    for (const KnownLeg::Point& p : known.points)
      f[next++] = (leg.offsetAt(p.along_mm) - p.offset_mm) / p.sigma_mm;
  };
  hold(shape.in, known_.in);
  hold(shape.out, known_.out);
  f.tail<kPriors>() << x[kInSlope] / kSlopeSigma, x[kOutSlope] / kSlopeSigma,
      x[kInCurvature] / known_.in.curvature_sigma_per_mm,
      x[kOutCurvature] / known_.out.curvature_sigma_per_mm, x[kInTwist] / known_.in.twist_sigma_per_mm2,
      x[kOutTwist] / known_.out.twist_sigma_per_mm2, (x[kPeakIn] - std::log(light.peak_in)) / kPeakSigma,
      (x[kPeakOut] - std::log(light.peak_out)) / kPeakSigma,
      (x[kRadius] - std::log(light.beam_radius_mm)) / known_.radius_share_sigma,
      (x[kBoard] - light.board_gray) / kBoardSigma, (x[kOpen] - light.open_gray) / kOpenSigma,
      (x[kBlur] - light.blur_px) / std::hypot(known_.blur_sigma_px, kBlurShapePx),
      x[kInScorch] / kScorchSigma_mm, x[kOutScorch] / kScorchSigma_mm,
      (x[kLaw] - light.growth.law) / known_.law_sigma, (x[kBegin] - light.growth.begin) / known_.begin_sigma,
      0.0, 0.0;
  if (x.size() > kMeet + 1) {
    const double together_mm = std::abs(x[kMeet]);
    const double apart_mm = x[kMeet + 1];
    f[f.size() - 2] = apart_mm / (together_mm + kUneven_mm);
    f[f.size() - 1] = std::max(0.0, std::abs(apart_mm) - together_mm) / kOpposite_mm;
  }
  return 0;
}

int CornerProblem::df(const VectorXd& x, MatrixXd& jacobian) const {
  VectorXd here(values());
  VectorXd there(values());
  (*this)(x, here);
  for (Index k = 0; k < inputs_; ++k) {
    const bool length = k == kInOffset || k == kOutOffset || k >= kInScorch;
    const bool gray = k == kBoard || k == kOpen;
    const double step = length ? kLengthStep_mm : gray ? kGrayStep : kOtherStep;
    VectorXd y = x;
    y[k] += step;
    (*this)(y, there);
    jacobian.col(k) = (there - here) / step;
  }
  return 0;
}

}  // namespace kerfbench::vision
