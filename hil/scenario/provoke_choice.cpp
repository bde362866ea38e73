// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/provoke_choice.h"

#include <fmt/format.h>

#include "hil/controller/uart_listener.h"

namespace kerfbench::scenario {

namespace {

using Cause = ProvokeChoice::Cause;

struct CauseKey {
  const char* key;
  Cause cause;
};

constexpr CauseKey kTimed[] = {
    {"interlock_open_at_s", Cause::kInterlock}, {"limit_hit_at_s", Cause::kLimit},
    {"encoder_lost_at_s", Cause::kEncoder},     {"uart_silent_at_s", Cause::kUartSilent},
    {"uart_noise_at_s", Cause::kUartNoise},     {"marks_flicker_at_s", Cause::kMarksFlicker}};

}  // namespace

ProvokeChoice readProvoke(base::YamlReader provoke, bool belt_is_followed) {
  ProvokeChoice choice;
  std::string causes;
  const auto found = [&](const char* key, Cause cause) {
    causes += fmt::format("{}{}", causes.empty() ? "" : ", ", key);
    if (choice.cause != Cause::kNone) provoke.fault(key, "one thing at a time: " + causes);
    choice.cause = cause;
    const bool of_belt = cause == Cause::kEncoder || cause == Cause::kMarksFlicker ||
                         cause == Cause::kBeltTooFast || cause == Cause::kFieldLeft;
    if (of_belt && !belt_is_followed)
      provoke.fault(key, "needs a belt that the line drives: the controller follows no other");
  };
  for (const CauseKey& timed : kTimed) {
    if (!provoke.has(timed.key)) continue;
    found(timed.key, timed.cause);
    choice.at_s = provoke.number(timed.key, {.min = 1e-6, .max = 36000});
  }
  if (provoke.has("host_starves_after_share")) {
    found("host_starves_after_share", Cause::kHostStarves);
    choice.share = provoke.number("host_starves_after_share", {.min = 0.01, .max = 0.99});
  }
  if (provoke.boolean("belt_too_fast", false)) found("belt_too_fast", Cause::kBeltTooFast);
  if (provoke.boolean("field_left", false)) found("field_left", Cause::kFieldLeft);
  // What only says how needs the cause that it belongs to.
  const auto belongs = [&](const char* key, bool to_it) {
    if (provoke.has(key) && !to_it) provoke.fault(key, "belongs to a cause that is not there");
  };
  choice.open_for_s = provoke.number("interlock_open_for_s", {.min = 1e-6, .max = 36000, .fallback = 0.02});
  belongs("interlock_open_for_s", choice.cause == Cause::kInterlock);
  choice.limit = provoke.choice("limit", {"x", "y"}, "x");
  belongs("limit", choice.cause == Cause::kLimit);
  choice.encoder_lines = provoke.choice("encoder_lines", {"both", "a", "b"}, "both");
  belongs("encoder_lines", choice.cause == Cause::kEncoder);
  const double noise = provoke.number("uart_noise_share", {.min = 1e-6, .max = 1, .fallback = 1.0});
  belongs("uart_noise_share", choice.cause == Cause::kUartNoise);
  if (choice.cause == Cause::kUartNoise) choice.share = noise;
  if (provoke.has("expect")) choice.expect = provoke.choice("expect", controller::faultNames());
  belongs("expect", choice.cause != Cause::kNone);
  return choice;
}

std::vector<Signal> signalsOf(const ProvokeChoice& choice) {
  switch (choice.cause) {
    case Cause::kInterlock:
      return {Signal::kInterlock};
    case Cause::kLimit:
      return {choice.limit == "x" ? Signal::kLimitX : Signal::kLimitY};
    case Cause::kEncoder:
    case Cause::kBeltTooFast:
    case Cause::kFieldLeft:
      return {Signal::kEncoderA, Signal::kEncoderB};
    case Cause::kMarksFlicker:
      return {Signal::kPrintMark};
    default:
      return {};
  }
}

}  // namespace kerfbench::scenario
