// SPDX-License-Identifier: Apache-2.0
// The derivatives by which a corner is fitted, against differences of whole pictures.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/vision/corner/corner_model.h"
#include "hil/vision/corner/corner_problem.h"

namespace kerfbench::vision {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A corner's parameter: how far a difference goes to either side, and the step of its derivative. Light
/// bends where board begins to burn and where it is through, so that a difference must be small.
struct Parameter {
  const char* name;
  double difference, step;
};

constexpr std::array<Parameter, kMeet> kParameters{{{"offset in", 1e-4, 1e-6},
                                                    {"slope in", 1e-4, 1e-6},
                                                    {"curvature in", 1e-3, 1e-6},
                                                    {"twist in", 5e-3, 1e-6},
                                                    {"offset out", 4e-5, 1e-6},
                                                    {"slope out", 1e-4, 1e-6},
                                                    {"curvature out", 3e-4, 1e-6},
                                                    {"twist out", 1e-3, 1e-6},
                                                    {"peak in", 5e-4, 1e-6},
                                                    {"peak out", 5e-4, 1e-6},
                                                    {"radius", 5e-4, 1e-6},
                                                    {"board", 0.5, 1e-6},
                                                    {"open", 0.5, 1e-6},
                                                    {"blur", 1e-2, 2e-3},
                                                    {"scorch in", 1e-4, 1e-6},
                                                    {"scorch out", 4e-5, 1e-6},
                                                    {"law", 5e-3, 5e-4},
                                                    {"begin", 5e-4, 1e-6}}};
constexpr Parameter kRounding{"rounding", 1e-4, 1e-6};
constexpr std::array<Parameter, 2> kOverruns{{{"both ends", 1e-4, 1e-6}, {"one end more", 1e-4, 1e-6}}};

class CornerDerivative : public testing::TestWithParam<Meeting> {
 protected:
  CornerDerivative() : model_(grid(), std::vector<bool>(grid().size(), true), legs()) {
    CornerShape shape = legs();
    shape.in.offset_mm = 0.004;
    shape.in.slope = 0.003;
    shape.in.curvature_per_mm = 0.02;
    shape.out.offset_mm = -0.006;
    shape.out.twist_per_mm2 = 0.05;
    shape.rounding_mm = GetParam() == Meeting::kArc ? 0.04 : 0.0;
    if (GetParam() == Meeting::kEnds) setEnds(0.03, -0.01, shape);
    CornerLight light{
        .peak_in = 1.6, .peak_out = 1.4, .beam_radius_mm = 0.105, .board_gray = 30.0, .open_gray = 210.0};
    light.growth = {0.4, 0.1};
    x_ = parametersOf(shape, light, GetParam());
    model_.linearizeAt(shapeOf(x_, legs()), lightOf(x_), gray_);
  }
  static PixelGrid grid() { return {44, 44, {-0.86, -0.2}, {0.025, 0.0}, {0.0, 0.025}}; }
  /// A right angle with a leg that is bent as drawn.
  static CornerShape legs() {
    CornerShape shape;
    shape.out.bend_per_mm = 0.1;
    return shape;
  }
  [[nodiscard]] Parameter parameter(Index k) const {
    if (k < kMeet) return kParameters.at(static_cast<std::size_t>(k));
    return GetParam() == Meeting::kArc ? kRounding : kOverruns.at(static_cast<std::size_t>(k - kMeet));
  }
  std::vector<float> pictureOf(const VectorXd& x) {
    std::vector<float> gray;
    model_.render(shapeOf(x, legs()), lightOf(x), gray);
    return gray;
  }

  CornerModel model_;
  VectorXd x_;
  std::vector<float> gray_;
};

TEST_P(CornerDerivative, IsThatOfWholePictures) {
  EXPECT_EQ(gray_, pictureOf(x_)) << "the parts add up to the picture";
  for (Index k = 0; k < x_.size(); ++k) {
    const Parameter which = parameter(k);
    const VectorXd unit = VectorXd::Unit(x_.size(), k);
    std::vector<float> rate;
    const VectorXd next = x_ + which.step * unit;
    model_.rateTowards(shapeOf(next, legs()), lightOf(next), which.step, rate);
    const std::vector<float> more = pictureOf(x_ + which.difference * unit);
    const std::vector<float> less = pictureOf(x_ - which.difference * unit);
    double square = 0.0, wrong = 0.0;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      const double slope =
          (static_cast<double>(more[i]) - static_cast<double>(less[i])) / (2.0 * which.difference);
      square += slope * slope;
      wrong += std::pow(rate[i] - slope, 2);
    }
    EXPECT_GT(square, 0.0) << which.name;
    EXPECT_LT(std::sqrt(wrong / square), 0.02) << which.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Corners, CornerDerivative, testing::Values(Meeting::kArc, Meeting::kEnds),
                         [](const auto& tested) {
                           return tested.param == Meeting::kArc ? std::string("Arc") : std::string("Ends");
                         });

}  // namespace
}  // namespace kerfbench::vision
