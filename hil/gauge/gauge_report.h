// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/gauge/gauge.h"

namespace kerfbench::gauge {

/// Machine, cameras and command of a result.
struct GaugeFacts {
  std::string machine;                   ///< Name of the machine.
  std::string kerf_camera, spot_camera;  ///< Calibrations, in words.
  std::string command;                   ///< Command that repeats the result.
  std::string version;
};

/// JSON of the whole result, keys in a fixed order, lengths in mm to 1 nm; the same bytes for the same
/// result.
std::string gaugeJson(const GaugeResult& result, const GaugeOptions& options, const GaugeFacts& facts);
/// One self-contained page.
std::string gaugeHtml(const GaugeResult& result, const GaugeOptions& options, const GaugeFacts& facts);

// Figures of the page. Private to hil/gauge and its tests.

/// Error over true size, with the median U of each class of sizes as a band.
std::string biasPlot(const std::vector<GaugePoint>& points, const std::optional<Linearity>& line);
/// Histogram of error over U, with what a right U would show.
std::string zPlot(const std::vector<GaugePoint>& points);
/// Errors of repeated measurements, one after the other.
std::string runChart(const std::vector<double>& errors_mm, const std::string& title);
/// Mean error of readings over the camera's field.
std::string fieldPlot(const std::vector<FieldCell>& field);
/// Operating characteristic: share of each verdict over the true deviation.
std::string verdictPlot(const std::vector<GaugePoint>& points, const std::string& title);
std::string detectablePlot(const std::vector<KindResult>& kinds);
/// Shares of intervals that hold the truth, each with its own 95 % interval.
std::string coveragePlot(const std::vector<Coverage>& coverage);

}  // namespace kerfbench::gauge
