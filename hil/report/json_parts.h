// SPDX-License-Identifier: Apache-2.0
#pragma once

// What verdict.json and the digest have in common. Private to hil/report.

#include <cmath>

#include <nlohmann/json.hpp>

#include "hil/inspect/inspect.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::report {

using Json = nlohmann::json;                 // Keys sorted: canonical.
using OrderedJson = nlohmann::ordered_json;  // Keys as a reader likes them.

/// 1 nm for lengths in mm, 1e-6 for the rest; null where there is no number.
inline Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6 + 0.0;  // + 0.0 turns -0 into 0.
}

template <typename J>
J checkJson(const inspect::Check& c) {
  J j;
  j["name"] = c.name;
  j["verdict"] = inspect::verdictName(c.verdict);
  j["value"] = rounded(c.value);
  j["unit"] = c.unit;
  j["limit"] = rounded(c.limit);
  j["limit_is"] = c.upper ? "upper" : "lower";
  j["guard"] = rounded(c.guard);
  j["expanded_uncertainty"] = rounded(c.u);
  j["chance_beyond_limit"] = rounded(c.chance_beyond);
  j["subject"] = c.subject;
  return j;
}

template <typename J>
J unjudgedJson(const inspect::Unjudged& u) {
  J j;
  j["name"] = u.name;
  j["title"] = u.title;
  j["applies"] = u.applies;
  j["reason"] = u.reason;
  return j;
}

template <typename J>
J entityJson(const inspect::EntityResult& e) {
  J j;
  j["unit"] = e.unit;
  j["entity"] = e.entity;
  j["worst_mm"] = rounded(e.worst_mm);
  j["worst_U_mm"] = rounded(e.worst_U_mm);
  j["worst_u"] = rounded(e.worst_u);
  j["rms_mm"] = rounded(e.rms_mm);
  j["rms_U_mm"] = rounded(e.rms_U_mm);
  j["coverage"] = rounded(e.coverage);
  j["uncut_mm"] = rounded(e.uncut_mm);
  j["width_mm"] = rounded(e.width_mm);
  j["width_U_mm"] = rounded(e.width_U_mm);
  j["circularity_mm"] = rounded(e.circularity_mm);
  j["circularity_U_mm"] = rounded(e.circularity_U_mm);
  j["passes"] = rounded(e.passes);
  return j;
}

template <typename J>
J cutJson(const inspect::CutResult& c) {
  J j;
  j["unit"] = c.unit;
  j["entity"] = c.entity;
  j["start_s"] = rounded(c.start_s);
  j["end_s"] = rounded(c.end_s);
  j["frames"] = c.frames;
  j["drift_mm"] = rounded(c.drift_mm);
  j["drift_sigma_mm"] = rounded(c.drift_sigma_mm);
  j["slope_mm_s"] = rounded(c.slope_mm_s);
  j["slope_sigma_mm_s"] = rounded(c.slope_sigma_mm_s);
  j["offset_mm"] = rounded(c.offset_mm);
  j["offset_sigma_mm"] = rounded(c.offset_sigma_mm);
  j["excursion_mm"] = rounded(c.excursion_mm);
  j["excursion_U_mm"] = rounded(c.excursion_U_mm);
  j["peak_mm"] = rounded(c.peak_mm);
  j["peak_U_mm"] = rounded(c.peak_U_mm);
  j["rms_mm"] = rounded(c.rms_mm);
  j["rms_U_mm"] = rounded(c.rms_U_mm);
  j["top_speed_mm_s"] = rounded(c.top_speed_mm_s);
  j["top_speed_U_mm_s"] = rounded(c.top_speed_U_mm_s);
  return j;
}

template <typename J>
J quantityJson(const inspect::Quantity& q) {
  J j;
  j["value"] = rounded(q.value);
  j["U"] = rounded(q.U);
  return j;
}

template <typename J>
J jointJson(const inspect::JointResult& r) {
  J j = quantityJson<J>(r.mm);
  j["kind"] = inspect::jointName(r.kind);
  j["unit"] = r.unit;
  j["entity"] = r.entity;
  j["entity_out"] = r.entity_out;
  j["at_start"] = r.at_start;
  j["x_mm"] = rounded(r.p_S_mm.x());
  j["y_mm"] = rounded(r.p_S_mm.y());
  return j;
}

template <typename J>
J pulseJson(const PulseTiming& t) {
  J j;
  j["axis"] = t.axis;
  j["driver"] = t.profile.name;
  j["pulses"] = t.pulses;
  j["setup_violations"] = t.setup_violations;
  j["hold_violations"] = t.hold_violations;
  j["width_violations"] = t.width_violations;
  j["space_violations"] = t.space_violations;
  j["min_setup_us"] = rounded(1e6 * t.min_setup_s);
  j["min_hold_us"] = rounded(1e6 * t.min_hold_s);
  j["min_width_us"] = rounded(1e6 * t.min_width_s);
  j["min_space_us"] = rounded(1e6 * t.min_space_s);
  if (t.has_enable) {
    j["disabled_pulses"] = t.disabled_pulses;
    j["enable_setup_violations"] = t.enable_setup_violations;
    j["min_enable_setup_us"] = rounded(1e6 * t.min_enable_setup_s);
  }
  j["first_violation_s"] = rounded(t.first_violation_s);
  return j;
}

}  // namespace kerfbench::report
