// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/compare/kept_verdict.h"

#include <chrono>
#include <fstream>
#include <string>

#include "hil/judge/run_folder.h"

namespace kerfbench::compare {

nlohmann::json plainVerdict() {
  return nlohmann::json::parse(R"({
    "schema_version": 1, "verdict": "PASS", "digest": "1a2b3c4d5e6f", "inputs_digest": "0f",
    "scenario": "label", "machine": "two-mirror", "firmware": "controller.hex", "seed": 1,
    "model": {"twin": "fast", "imperfections": "ideal"},
    "versions": {"kerfbench": "0.1.0", "firmware sha256": "aa11"},
    "inputs": [{"file": "label.yaml", "sha256": "01"}, {"file": "controller.hex", "sha256": "aa11"}],
    "checks": [
      {"name": "path", "verdict": "PASS", "value": 0.01, "unit": "mm", "limit": 0.05, "limit_is": "upper",
       "expanded_uncertainty": 0.004, "subject": "unit 0, E0"},
      {"name": "pulse_timing", "verdict": "PASS", "value": 4.0, "unit": "µs", "limit": 0.0, "limit_is": "lower",
       "expanded_uncertainty": 0.0, "subject": "galvo_x"}],
    "not_judged": [{"name": "depth", "applies": false, "reason": "No crease."}],
    "entities": [{"unit": 0, "entity": 0, "worst_mm": 0.01, "worst_U_mm": 0.004, "rms_mm": 0.004, "rms_U_mm": 0.002,
      "coverage": 1.0, "uncut_mm": 0.0, "width_mm": 0.2, "width_U_mm": 0.01, "circularity_mm": null,
      "circularity_U_mm": null}],
    "joints": [{"kind": "corner", "value": 0.0, "U": 0.008, "unit": 0, "entity": 0, "entity_out": 1, "at_start": false}],
    "cuts": {"list": [
      {"unit": 0, "entity": 0, "frames": 400, "drift_mm": 0.0, "drift_sigma_mm": 0.001, "slope_mm_s": 0.0,
       "slope_sigma_mm_s": 0.002, "offset_mm": -0.003, "offset_sigma_mm": 0.001, "excursion_mm": null,
       "excursion_U_mm": null, "peak_mm": 0.01, "peak_U_mm": 0.01, "rms_mm": 0.001, "rms_U_mm": 0.001,
       "top_speed_mm_s": 300.0, "top_speed_U_mm_s": 2.0}]}
  })");
}

std::filesystem::path keep(const nlohmann::json& verdict, const std::filesystem::path& results_dir,
                           int seconds) {
  judge::RunFolder folder(results_dir, verdict.at("scenario").get<std::string>());
  std::ofstream(folder.staging() / "verdict.json") << verdict.dump(2);
  folder.commit(std::chrono::sys_days{std::chrono::year{2026} / 11 / 28} + std::chrono::seconds(seconds),
                verdict.at("digest").get<std::string>());
  return folder.place();
}

}  // namespace kerfbench::compare
