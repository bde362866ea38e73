// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace kerfbench::planner {

/// Who gave the parameters of a job, and reads what is wrong with them.
enum class GivenBy { kScenario, kCommandLine };

/// Parameters that faults speak of.
enum class Parameter {
  kThrow,
  kMirrorSpacing,
  kMirrorStep,
  kMirrorAcceleration,
  kFullStepPulses,
  kDetentShare,
  kRotorResonance,
  kRotorDamping,
  kFocalLength,
  kGantryStep,
  kFieldX,
  kFieldY,
  kTrackingDelay,
  kEncoderCount,
  kPrintMarkSensor,
  kFeedStep,
  kFullPower,
  kPowerQuantum,
  kPowerDelay,
  kLaserLag,
  kBeltSpeed,
  kBeltMin,
  kBeltMax,
  kMarkSpeed,
  kJumpSpeed,
  kAcceleration,
  kJumpAcceleration,
  kJumpRadius,
  kRunUp,
  kCornerError,
  kJerk,
  kCutEnergy,
  kHalfZ,
  kPerforationCut,
  kPerforationGap,
  kKerfRadius,
  kAllowLost,
  kUnits,
  kPitch,
  kEyeMark,
  kWebStart,
  kFeed,
  kFeedAcceleration,
  kStopAndGo,
  kMaterial,
  kDepth,
  kHalfDepth,
  kSpotDiameter,
};

/// What a parameter is called.
struct ParameterName {
  Parameter parameter{};
  const char* option{};  ///< Option of kerfplan; null where it has none.
  /// Key of a scenario, or of a machine file, whose section for this is `controller`; null where there is
  /// none.
  const char* key{};
  double key_scale{1.0};  ///< Factor from the planner's unit, which is the option's, to that of the key.
};

/// Names of all parameters, each once.
std::span<const ParameterName> parameterNames();

/// Name by which the giver knows a parameter: "--throw" or "controller.throw_mm".
std::string nameOf(Parameter parameter, GivenBy given_by);

/// Factor from the planner's unit to the one of the name.
double scaleOf(Parameter parameter, GivenBy given_by);

}  // namespace kerfbench::planner
