// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/vision/corner/corner_fit.h"

namespace kerfbench::vision {

/// Joint of two legs: an arc, or an end of each.
enum class Meeting { kArc, kEnds };

/// Order of a corner's parameters: the legs, what lights them, and how they meet: rounding, or what both run
/// over together and by how much more the leg in does.
enum CornerParameter : Eigen::Index {
  kInOffset,
  kInSlope,
  kInCurvature,
  kInTwist,
  kOutOffset,
  kOutSlope,
  kOutCurvature,
  kOutTwist,
  kPeakIn,
  kPeakOut,
  kRadius,
  kBoard,
  kOpen,
  kBlur,
  kInScorch,
  kOutScorch,
  kLaw,
  kBegin,
  kMeet
};
constexpr Eigen::Index kLegParameters = 8;

Eigen::VectorXd parametersOf(const CornerShape& shape, const CornerLight& light, Meeting meeting);
/// Shape of these parameters; `shape` has the nominal curves.
CornerShape shapeOf(const Eigen::VectorXd& x, CornerShape shape);
CornerLight lightOf(const Eigen::VectorXd& x);
/// Sets the overrun of the legs.
void setEnds(double together_mm, double more_in_mm, CornerShape& shape);

/// Problem in the form of lmder: residuals in sigmas, those of prior knowledge last.
class CornerProblem {
 public:
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  /// Takes a picture and what is known; both must outlive the problem.
  CornerProblem(const CornerPicture& picture, const CornerKnown& known);
  /// Sets one noise for all pixels.
  void setNoise(double noise_gray) { noise_gray_.assign(used_.size(), noise_gray); }
  /// Sets the noise by the scatter about the model of pixels of the same brightness: it grows with the light,
  /// as light comes in photons and edges are rough.
  void setNoiseFrom(const Eigen::VectorXd& x);
  void setMeeting(Meeting meeting) { inputs_ = kMeet + (meeting == Meeting::kArc ? 1 : 2); }

  [[nodiscard]] int inputs() const { return static_cast<int>(inputs_); }
  [[nodiscard]] Eigen::Index pixels() const { return static_cast<Eigen::Index>(used_.size()); }
  [[nodiscard]] Eigen::Index points() const {
    return static_cast<Eigen::Index>(known_.in.points.size() + known_.out.points.size());
  }
  [[nodiscard]] int values() const { return static_cast<int>(pixels() + points() + kPriors); }

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& f) const;
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const;

 private:
  static constexpr Eigen::Index kPriors = 18;
  const CornerPicture& picture_;
  const CornerKnown& known_;
  mutable CornerModel model_;
  std::vector<std::size_t> used_;
  std::vector<double> noise_gray_;
  Eigen::Index inputs_{kMeet + 1};
  mutable std::vector<float> gray_;
};

}  // namespace kerfbench::vision
