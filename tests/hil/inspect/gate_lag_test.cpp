// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/checks/start_place.h"

namespace kerfbench::inspect {
namespace {

constexpr double kAcceleration_mm_s2 = 20000.0;
constexpr double kTop_mm_s = 300.0;
constexpr double kGate_s = 1.0;
constexpr double kSpotU_mm = 0.003;
/// Deviation of the beam's path by steps and servo, in addition to the camera's.
constexpr double kRough_mm = 0.005;

/// Standard uncertainty of where a kerf begins.
constexpr double kKerfEndU_mm = 0.008;

/// Length of path since the beam set off.
using Motion = double (*)(double t_s);

double dash(double t_s) { return 150.0 * t_s; }
/// Path out of a jump without a stop, at 120 mm/s and speeding up; offward(): at 140 mm/s and slowing down to
/// 80.
double onward(double t_s) { return t_s * (120.0 + 4500.0 * t_s); }
double offward(double t_s) {
  const double braked_s = std::min(t_s, 60.0 / 9000.0);
  return braked_s * (140.0 - 4500.0 * braked_s) + 80.0 * (t_s - braked_s);
}
/// Paths of slow cuts: ramps of 4.5 and 7.5 ms that end after 0.20 and 0.56 mm.
double rampTo(double top_mm_s, double t_s) {
  const double ramp_s = top_mm_s / kAcceleration_mm_s2;
  return t_s < ramp_s ? 0.5 * kAcceleration_mm_s2 * t_s * t_s : top_mm_s * (t_s - 0.5 * ramp_s);
}
double ramp(double t_s) { return rampTo(kTop_mm_s, t_s); }
double rampTo90(double t_s) { return rampTo(90.0, t_s); }
double rampTo150(double t_s) { return rampTo(150.0, t_s); }
double jerk(double t_s) { return 1e6 * t_s * t_s * t_s; }

/// A beam that follows one curve, seen once in a millisecond while the gate is open.
class Start {
 public:
  explicit Start(dieline::Curve curve, bool backwards = false,
                 dieline::Process process = dieline::Process::kCut)
      : backwards_(backwards) {
    dieline_.entities.push_back({0, std::move(curve), process, "CUT", "line 4: LINE"});
    evidence_.dieline = &dieline_;
  }
  Start(const Start&) = delete;
  Start& operator=(const Start&) = delete;

  /// Another line of the same dieline, on which no frame lies.
  void add(dieline::Curve curve) {
    const int id = static_cast<int>(dieline_.entities.size());
    dieline_.entities.push_back({id, std::move(curve), dieline::Process::kCut, "CUT", "line 8: LINE"});
  }

  /// The whole job lies displaced on its sheet by this much.
  void displace(const Eigen::Vector2d& by_mm) {
    displaced_mm_ = by_mm;
    limits_.path_mm = 0.1;
  }

  /// A beam whose power follows its speed: no frame shows it before it has come so far.
  void hideUntil(double way_mm) { dark_mm_ = way_mm; }

  /// What the camera's clock is off the pins', at most.
  void boundClock(double bound_s) { evidence_.clock_bound_s = bound_s; }

  /// The start of the kerf of the beam's line was measured, so far too short.
  void measureKerfStart(double gap_mm) {
    evidence_.kerf_calibration.emplace();
    evidence_.kerf.units = {vision::UnitPose{}};
    evidence_.kerf.ends.push_back({.unit = 0,
                                   .entity = 0,
                                   .at_start = !backwards_,
                                   .found = true,
                                   .gap_mm = gap_mm,
                                   .sigma_mm = kKerfEndU_mm});
  }

  /// Check of one start. `lag_s` > 0: the gate opens after the beam sets off.
  Finding seen(double lag_s, Motion motion = ramp, unsigned seed = 0, int frames = 1000,
               double pin_u_s = 0.0) {
    LitFrames lit;
    evidence_.pin_u_s = pin_u_s;
    evidence_.gates = {cut(lit, kGate_s, lag_s, motion, seed, frames)};
    for (std::size_t id = 1; id < dieline_.entities.size(); ++id) followAfter(lit, id);
    return checks::gateLagCheck(evidence_, limits_, lit);
  }

  /// Check of two cuts along the curve, one after the other.
  Finding seenTwice(double first_lag_s, double second_lag_s) {
    LitFrames lit;
    evidence_.gates = {cut(lit, kGate_s, first_lag_s, ramp, 0, 1000)};
    evidence_.gates.push_back(cut(lit, evidence_.gates[0].off_s + 0.05, second_lag_s, ramp, 0, 1000));
    return checks::gateLagCheck(evidence_, limits_, lit);
  }

 private:
  /// Ten frames in full run on another line that is long enough for frames, after the last frame so far.
  void followAfter(LitFrames& lit, std::size_t id) {
    const dieline::Curve& curve = dieline_.entities[id].curve;
    const double length_mm = dieline::lengthOf(curve);
    if (length_mm < 10.0) return;
    const double begin_s = evidence_.gates.back().off_s + 0.05;
    for (int i = 1; i <= 10; ++i) {
      LitFrame frame;
      frame.time_s = begin_s + 1e-3 * i;
      frame.entity = static_cast<int>(id);
      frame.sigma_mm = kSpotU_mm;
      place(frame, curve, (3.0 + 0.3 * i) / length_mm);
      lit.frames.push_back(frame);
    }
    // The gate opened long before: a line in full run says nothing of how the beam set off.
    evidence_.gates.push_back({begin_s - 0.01, begin_s + 0.011});
  }

  /// Puts a frame on the displaced curve.
  void place(LitFrame& frame, const dieline::Curve& curve, double u) const {
    const Eigen::Vector2d tangent = dieline::tangentAt(curve, u);
    frame.p_S_mm = dieline::pointAt(curve, u) + displaced_mm_;
    frame.deviation_mm = displaced_mm_.dot(Eigen::Vector2d(-tangent.y(), tangent.x()));
  }

  GateInterval cut(LitFrames& lit, double gate_s, double lag_s, Motion motion, unsigned seed,
                   int frames) const {
    const dieline::Curve& curve = dieline_.entities.front().curve;
    const double length_mm = dieline::lengthOf(curve);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, seed == 0 ? 0.0 : std::hypot(kSpotU_mm, kRough_mm));
    const std::size_t before = lit.frames.size();
    double off_s = gate_s;
    // The phase of the camera's period at which the gate opens differs from start to start.
    for (double t_s = gate_s + 1e-4 * (1 + seed % 9); std::cmp_less(lit.frames.size() - before, frames);
         t_s += 1e-3) {
      const double since_s = t_s - gate_s + lag_s;
      const double way_mm = since_s > 0 ? motion(since_s) : 0.0;
      if (way_mm > length_mm) break;
      if (way_mm < dark_mm_) continue;
      const double share = way_mm / length_mm;
      LitFrame frame;
      frame.time_s = off_s = t_s;
      frame.entity = 0;
      frame.sigma_mm = kSpotU_mm;
      place(frame, curve, backwards_ ? 1.0 - share : share);
      frame.p_S_mm += Eigen::Vector2d(noise(random), noise(random));
      lit.frames.push_back(frame);
    }
    return {gate_s, off_s + 1e-4};
  }

  dieline::Dieline dieline_;
  Evidence evidence_;
  Tolerances limits_;
  Eigen::Vector2d displaced_mm_{Eigen::Vector2d::Zero()};
  bool backwards_;
  double dark_mm_{0.0};
};

const dieline::Curve kLine = dieline::LineCurve{{0, 0}, {40, 30}};
const dieline::Curve kArc = dieline::ArcCurve{{15, 20}, 6, 0, 1.5 * std::numbers::pi};
const dieline::Curve kCircle = dieline::ArcCurve{{15, 20}, 6, 0, 2 * std::numbers::pi};

TEST(GateLag, AStartOnALineTooShortForFramesIsNotTakenForALateOneOnTheNext) {
  // The gate opened 2 ms before the beam came to the long line, whichever way the short one was drawn.
  for (const dieline::LineCurve& before :
       {dieline::LineCurve{{-0.3, 0.0}, {0.0, 0.0}}, dieline::LineCurve{{0.0, 0.0}, {-0.3, 0.0}}}) {
    Start start(kLine);
    start.add(before);
    EXPECT_FALSE(start.seen(-0.002));
  }
  Start alone(kLine);
  alone.add(dieline::LineCurve{{-20.0, 0.0}, {0.0, 0.0}});
  EXPECT_EQ(alone.seen(-0.002)->verdict, Verdict::kFail) << "a neighbour that has frames of its own";
  Start beside(kLine);
  beside.add(dieline::LineCurve{{-1.1, 0.0}, {0.0, 0.0}});
  EXPECT_EQ(beside.seen(-0.002)->verdict, Verdict::kFail)
      << "and so has one a little longer than a millimetre";
}

TEST(GateLag, ARampThatIsSoonOverIsNotTakenForAStartAtFullSpeed) {
  // The way in full run points to half a ramp after the gate: as early a gate, if the start were at full
  // speed.
  for (unsigned seed = 0; seed < 100; ++seed) {
    for (const Motion motion : {rampTo90, rampTo150}) {
      const Finding check = Start(kLine).seen(0.0, motion, seed);
      if (check) EXPECT_EQ(check->verdict, Verdict::kPass) << seed << check->explanation;
    }
  }
}

/// The begin of such a ramp was not seen: it may as well be a beam that comes out of a jump.
TEST(GateLag, AGateThatIsLateByHalfARampDoesNotSeemToBeInTime) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Finding check = Start(kLine).seen(0.00375, rampTo150, seed);
    if (check) EXPECT_EQ(check->verdict, Verdict::kFail) << seed << check->explanation;
  }
}

/// A beam out of a smooth jump speeds up from 40 mm/s to 100, and keeps that.
double onwardToCruise(double t_s) {
  const double ramp_s = std::min(t_s, 0.006);
  return ramp_s * (40.0 + 5000.0 * ramp_s) + 100.0 * (t_s - ramp_s);
}
TEST(GateLag, ABeamThatComesOutOfAJumpAndCruisesIsNotTakenForALateGate) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Finding check = Start(kLine).seen(0.0, onwardToCruise, seed);
    if (check) EXPECT_NE(check->verdict, Verdict::kFail) << seed << check->explanation;
  }
}

TEST(GateLag, ARampThatIsSoonOverHasItsIntervalToo) {
  for (const double lag_s : {-0.002, 0.0, 0.0003}) {
    int inside = 0;
    int seen = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const Finding check = Start(kLine).seen(lag_s, rampTo150, seed);
      if (!check) continue;
      ++seen;
      inside += std::abs(check->value - 1e3 * std::abs(lag_s)) <= check->u ? 1 : 0;
    }
    EXPECT_GE(seen, 50) << lag_s;
    const double least = 0.95 - 3.1 * std::sqrt(0.95 * 0.05 / seen);
    EXPECT_GE(inside, seen * least) << lag_s << " of " << seen;
  }
}

TEST(GateLag, OfABeamThatIsDarkAtRestNoEarlyGateIsClaimed) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Start start(kLine);
    start.hideUntil(0.15);
    const Finding check = start.seen(0.0, rampTo90, seed);
    if (check) EXPECT_NE(check->verdict, Verdict::kFail) << seed << check->explanation;
  }
}

TEST(GateLag, WhatNoFrameCanHaveSeenIsNotGuessed) {
  Start start(kLine);
  EXPECT_FALSE(start.seen(0.3)) << start.seen(0.3)->explanation;
}

/// A circle that is cut from a place a little farther on looks like a late gate at its drawn start.
TEST(GateLag, AClosedCurveMayBeCutFromAnyPlaceOn) {
  for (const double lag_s : {0.0, 0.002, 0.01}) EXPECT_FALSE(Start(kCircle).seen(lag_s, dash)) << lag_s;
}

TEST(GateLag, FindsTheLagOnLinesAndArcsEitherWay) {
  for (const dieline::Curve& curve : {kLine, kArc}) {
    for (const bool backwards : {false, true}) {
      for (const Motion motion : {ramp, dash}) {
        SCOPED_TRACE(curve.index());
        SCOPED_TRACE(backwards ? "backwards" : "forwards");
        SCOPED_TRACE(motion == ramp ? "ramp" : "dash");
        Start start(curve, backwards);
        const auto in_time = start.seen(0.0, motion);
        ASSERT_TRUE(in_time);
        EXPECT_LT(in_time->value, 0.2);
        EXPECT_EQ(in_time->verdict, Verdict::kPass) << in_time->explanation;

        const auto late = start.seen(0.002, motion);
        ASSERT_TRUE(late);
        EXPECT_NEAR(late->value, 2.0, 0.2);
        EXPECT_EQ(late->verdict, Verdict::kFail);
        EXPECT_NE(late->explanation.find("after the beam set off"), std::string::npos) << late->explanation;

        const auto early = start.seen(-0.002, motion);
        ASSERT_TRUE(early);
        EXPECT_NEAR(early->value, 2.0, 0.2);
        EXPECT_EQ(early->verdict, Verdict::kFail);
        EXPECT_NE(early->explanation.find("before the beam set off"), std::string::npos)
            << early->explanation;
      }
    }
  }
}

TEST(GateLag, ItsIntervalHoldsTheTrueLagInNineteenOfTwenty) {
  for (const Motion motion : {ramp, dash}) {
    for (const double lag_s : {0.0003, 0.002}) {
      int inside = 0;
      int seen = 0;
      for (unsigned seed = 1; seed <= 200; ++seed) {
        const auto check = Start(kLine).seen(lag_s, motion, seed);
        if (!check) continue;
        ++seen;
        inside += std::abs(check->value - 1e3 * lag_s) <= check->u ? 1 : 0;
      }
      EXPECT_GE(seen, 180);
      // The noise is that of the check's model, so 95 % are required; by chance 200 starts may show 3.1
      // standard deviations less, one time in a thousand.
      const double least = 0.95 - 3.1 * std::sqrt(0.95 * 0.05 / seen);
      EXPECT_GE(inside, seen * least) << (motion == ramp ? "ramp " : "dash ") << lag_s;
    }
  }
}

const Eigen::Vector2d kAlong(0.8, 0.6);
constexpr double kFar_mm = 0.098;  ///< Displacement by 0.98 of the path's limit.
/// Line across kLine, on which a job displaced along kLine lies off.
const dieline::Curve kAcross = dieline::LineCurve{{40, 30}, {34, 38}};

TEST(GateLag, AJobDisplacedAlongItsLinesIsNotTakenForALateOrEarlyGate) {
  for (const Motion motion : {ramp, dash}) {
    for (const bool backwards : {false, true}) {
      for (const double far_mm : {kFar_mm, -kFar_mm}) {
        SCOPED_TRACE(motion == ramp ? "ramp" : "dash");
        SCOPED_TRACE(fmt::format("{} {}", backwards ? "backwards" : "forwards", far_mm));
        Start start(kLine, backwards);
        start.displace(far_mm * kAlong);
        start.add(kAcross);
        const Finding check = start.seen(0.00009, motion);
        ASSERT_TRUE(check) << check.why().reason;
        EXPECT_NEAR(check->value, 0.09, check->u);
        EXPECT_LT(check->value, 0.25) << "the line across shows how far the job lies off";
        EXPECT_EQ(check->verdict, Verdict::kPass) << check->explanation;
      }
    }
  }
}

TEST(GateLag, WhereTheKerfBeginsTellsWhereABeamSetOffFromRest) {
  for (const double far_mm : {kFar_mm, -kFar_mm}) {
    Start start(kLine);
    start.displace(far_mm * kAlong);
    start.measureKerfStart(far_mm);
    const Finding check = start.seen(0.00009);
    ASSERT_TRUE(check);
    EXPECT_NEAR(check->value, 0.09, check->u);
    EXPECT_EQ(check->verdict, Verdict::kPass) << check->explanation;
  }
}

TEST(GateLag, AnUnknownDisplacementIsPartOfItsUncertainty) {
  // All lines run the same way, and at full speed at once: a late gate and a job that lies farther on look
  // alike, and the kerf begins where the gate opened in either case.
  Start start(kLine);
  start.displace(kFar_mm * kAlong);
  start.measureKerfStart(kFar_mm);
  const Finding check = start.seen(0.00009, dash);
  ASSERT_TRUE(check);
  EXPECT_EQ(check->verdict, Verdict::kNotProven) << check->explanation;
  EXPECT_NEAR(check->value, 0.09, check->u);
}

TEST(GateLag, ItsIntervalHoldsTheTrueLagOfDisplacedJobsToo) {
  for (const Motion motion : {ramp, dash}) {
    for (const double lag_s : {-0.0003, 0.0003}) {
      int inside = 0;
      int seen = 0;
      for (unsigned seed = 1; seed <= 200; ++seed) {
        std::mt19937 random(1000 + seed);
        std::normal_distribution<double> unit;
        const double far_mm = 0.04 * unit(random);
        Start start(kLine);
        start.displace(far_mm * kAlong);
        start.measureKerfStart(far_mm + motion(std::max(lag_s, 0.0)) + kKerfEndU_mm * unit(random));
        start.add(kAcross);
        const Finding check = start.seen(lag_s, motion, seed);
        if (!check) continue;
        ++seen;
        inside += std::abs(check->value - 1e3 * std::abs(lag_s)) <= check->u ? 1 : 0;
      }
      EXPECT_GE(seen, 150);
      const double least = 0.95 - 3.1 * std::sqrt(0.95 * 0.05 / seen);
      EXPECT_GE(inside, seen * least) << (motion == ramp ? "ramp " : "dash ") << lag_s;
    }
  }
}

TEST(GateLag, AGateThatIsLateOnADisplacedJobFails) {
  for (const Motion motion : {ramp, dash}) {
    for (const double far_mm : {kFar_mm, -kFar_mm, 0.0}) {
      for (const double lag_s : {0.002, -0.002}) {
        for (const bool across : {false, true}) {
          for (const bool measured : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {} {} {} {}", motion == ramp ? "ramp" : "dash", far_mm, lag_s,
                                     across ? "a line across" : "", measured ? "measured" : ""));
            // Then nothing tells how far the job lies off.
            if (!across && !measured && far_mm != 0.0) continue;
            Start start(kLine);
            start.displace(far_mm * kAlong);
            if (across) start.add(kAcross);
            if (measured) start.measureKerfStart(far_mm + motion(std::max(lag_s, 0.0)));
            const Finding check = start.seen(lag_s, motion);
            ASSERT_TRUE(check);
            EXPECT_NEAR(check->value, 2.0, check->u);
            EXPECT_EQ(check->verdict, Verdict::kFail) << check->explanation;
          }
        }
      }
    }
  }
}

TEST(GateLag, ThePinsErrorIsPartOfItsUncertainty) {
  Start start(kLine);
  const auto exact = start.seen(0.002);
  const auto stamped = start.seen(0.002, ramp, 0, 1000, 40e-6);
  ASSERT_TRUE(exact && stamped);
  EXPECT_NEAR(std::hypot(exact->u, 2.0 * 0.040), stamped->u, 0.001) << "0.040 ms is one sigma of the pin";
}

TEST(GateLag, EachGateHasItsOwnFrames) {
  // The second of two cuts along the same line is late by 2 ms: half of the starts must show it.
  const auto check = Start(kLine).seenTwice(0.0, 0.002);
  ASSERT_TRUE(check);
  EXPECT_EQ(check->verdict, Verdict::kFail);
  EXPECT_NE(check->explanation.find("At 2 starts"), std::string::npos) << check->explanation;
  EXPECT_NE(check->explanation.find("1.00 ms after"), std::string::npos) << check->explanation;
}

TEST(GateLag, AClockThatIsKnownTooLooselyProvesNoStartInTime) {
  Start start(kLine);
  start.boundClock(0.0002);
  EXPECT_TRUE(start.seen(0.0)) << "known to less than half of the limit";
  start.boundClock(0.0003);
  EXPECT_FALSE(start.seen(0.0));
  EXPECT_TRUE(start.seen(0.003)) << "late whatever the clock";
}

TEST(StartPlace, IsKnownNoBetterThanLinesKeepToOneDisplacement) {
  // Three lines side by side. No displacement explains all: the one that fits best, by their mean, misses
  // them by 30, 30 and 60 um, 42 um RMS.
  dieline::Dieline dieline;
  LitFrames lit;
  for (const double off_mm : {0.07, 0.07, -0.02}) {
    const int id = static_cast<int>(dieline.entities.size());
    const double y_mm = 10.0 * id;
    dieline.entities.push_back(
        {id, dieline::LineCurve{{0, y_mm}, {40, y_mm}}, dieline::Process::kCut, "CUT", ""});
    for (const double x_mm : {10.0, 20.0, 30.0}) {
      LitFrame& frame = lit.frames.emplace_back();
      frame.entity = id;
      frame.p_S_mm = {x_mm, y_mm};
      frame.deviation_mm = off_mm;
    }
  }
  Evidence evidence;
  evidence.dieline = &dieline;
  Tolerances limits;
  limits.path_mm = 1.0;
  const checks::StartPlace place = checks::Displacements(evidence, {}, limits, lit).along(0, {0.0, 1.0});
  // Lines scatter by 44 um about a displacement that is drawn in towards none, and is known to 20 um.
  EXPECT_NEAR(place.sigma_mm, std::hypot(0.0445, 0.020), 0.001);
}

TEST(GateLag, TooFewFramesSayNothing) {
  for (int frames = 0; frames < 4; ++frames) EXPECT_FALSE(Start(kLine).seen(0.0, ramp, 0, frames)) << frames;
  EXPECT_FALSE(Start(kLine).seen(0.002, dash, 0, 3));
}

TEST(GateLag, FourFramesOfABeamAtFullSpeedSuffice) {
  for (const double lag_s : {0.0003, 0.0006}) {
    const Finding check = Start(kLine).seen(lag_s, dash, 0, 4);
    ASSERT_TRUE(check) << lag_s;
    EXPECT_NEAR(check->value, 1e3 * lag_s, check->u);
  }
}

TEST(GateLag, AStartWithLimitedJerkIsNotJudged) { EXPECT_FALSE(Start(kLine).seen(0.0, jerk)); }

TEST(GateLag, AStartAtASpeedThatChangesIsNotTakenForALateGate) {
  int judged = 0;
  for (const Motion motion : {onward, offward}) {
    for (unsigned seed = 0; seed < 100; ++seed) {
      const auto check = Start(kLine).seen(0.0, motion, seed);
      if (!check) continue;
      ++judged;
      EXPECT_NE(check->verdict, Verdict::kFail) << seed << ": " << check->explanation;
    }
  }
  EXPECT_LT(judged, 20) << "noise now and then makes it look like a start at full speed";
}

TEST(GateLag, TheTeethOfAPerforationBeginInFullRun) {
  EXPECT_FALSE(Start(kLine, false, dieline::Process::kPerforation).seen(0.003));
}

TEST(GateLag, WithoutAGateThereIsNoCheck) {
  const dieline::Dieline dieline;
  Evidence evidence;
  evidence.dieline = &dieline;
  EXPECT_FALSE(checks::gateLagCheck(evidence, Tolerances{}, LitFrames{}));
}

}  // namespace
}  // namespace kerfbench::inspect
