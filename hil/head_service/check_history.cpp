// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/check_history.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/input_file.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/day.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kDaysPerMonth = 365.25 / 12.0;
constexpr int kFarthest_days = 3653;
constexpr std::size_t kLeastChecks = 3;

std::string lineOf(const HeadCheckRecord& record) {
  Json json{{"date", record.date},   {"machine", record.machine}, {"calibration", record.calibration},
            {"sheet", record.sheet}, {"holds", record.holds},     {"off_mm", record.off_mm}};
  for (std::size_t k = 0; k < kFollowedDrifts; ++k) {
    json["drifts"].push_back({{"name", calibrate::nameOf(static_cast<calibrate::HeadDrift>(k))},
                              {"value", record.drifts[k].value},
                              {"U", record.drifts[k].U}});
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// @throws nlohmann::json::exception, std::invalid_argument.
HeadCheckRecord recordIn(const std::string& line) {
  const nlohmann::json json = nlohmann::json::parse(line);
  HeadCheckRecord record{json.at("date"),
                         json.at("machine"),
                         json.at("calibration"),
                         json.at("sheet"),
                         json.at("holds"),
                         json.at("off_mm"),
                         {}};
  if (!calibrate::dayNumber(record.date)) throw std::invalid_argument("date: is no day like 2026-11-21");
  const auto& drifts = json.at("drifts");
  if (drifts.size() != kFollowedDrifts) throw std::invalid_argument("drifts: there are to be five");
  for (std::size_t k = 0; k < kFollowedDrifts; ++k) {
    record.drifts[k] = {drifts[k].at("value"), drifts[k].at("U")};
    if (!std::isfinite(record.drifts[k].value) || !(record.drifts[k].U > 0.0))
      throw std::invalid_argument("drifts: values are to be finite, U above 0");
  }
  return record;
}

bool isSame(const HeadCheckRecord& a, const HeadCheckRecord& b) {
  return a.date == b.date && a.machine == b.machine && a.calibration == b.calibration && a.sheet == b.sheet;
}

void sortByDate(std::vector<HeadCheckRecord>& records) {
  std::ranges::stable_sort(records, {}, &HeadCheckRecord::date);
}

/// A line a + b t, with the covariance of both.
struct Line {
  double a{}, b{}, aa{}, ab{}, bb{};
  [[nodiscard]] double at(double t) const { return a + b * t; }
  [[nodiscard]] double sigmaAt(double t) const { return std::sqrt(aa + 2.0 * ab * t + bb * t * t); }
};

Line lineThrough(const std::vector<double>& days, const std::vector<double>& values,
                 const std::vector<double>& sigmas) {
  double s = 0.0, t = 0.0, tt = 0.0, v = 0.0, tv = 0.0;
  for (std::size_t i = 0; i < days.size(); ++i) {
    const double w = 1.0 / (sigmas[i] * sigmas[i]);
    s += w;
    t += w * days[i];
    tt += w * days[i] * days[i];
    v += w * values[i];
    tv += w * days[i] * values[i];
  }
  const double determinant = s * tt - t * t;
  Line line{(tt * v - t * tv) / determinant, (s * tv - t * v) / determinant, tt / determinant,
            -t / determinant, s / determinant};
  double chi2 = 0.0;
  for (std::size_t i = 0; i < days.size(); ++i)
    chi2 += std::pow((values[i] - line.at(days[i])) / sigmas[i], 2);
  const double raised = std::max(1.0, chi2 / static_cast<double>(days.size() - 2));
  line.aa *= raised;
  line.ab *= raised;
  line.bb *= raised;
  return line;
}

}  // namespace

HeadCheckRecord recordOf(const calibrate::QuickCheckResult& result) {
  HeadCheckRecord record;
  record.holds = result.holds;
  for (std::size_t k = 0; k < kFollowedDrifts; ++k)
    record.drifts[k] = {result.of_head[k].value, 2.0 * result.of_head[k].sigma};
  return record;
}

std::vector<HeadCheckRecord> readCheckHistory(const fs::path& path) {
  std::vector<HeadCheckRecord> records;
  const base::InputContent content = base::readInput(path, base::kLargestRecord_bytes);
  if (!content.bytes && content.error != ENOENT)
    throw base::ConfigError(fmt::format("{}: {}", path.string(), content.refusal));
  std::istringstream file(content.bytes.value_or(""));
  std::string faults;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty()) continue;
    try {
      records.push_back(recordIn(line));
    } catch (const std::exception& error) {
      faults += fmt::format("{}{}:{}: is no check that this program kept: {}", faults.empty() ? "" : "\n",
                            path.string(), number, error.what());
    }
  }
  if (!faults.empty()) throw base::ConfigError(faults);
  sortByDate(records);
  return records;
}

std::vector<HeadCheckRecord> addToCheckHistory(const fs::path& path, const HeadCheckRecord& record) {
  std::vector<HeadCheckRecord> records = readCheckHistory(path);
  std::erase_if(records, [&](const HeadCheckRecord& other) { return isSame(other, record); });
  records.push_back(record);
  sortByDate(records);
  std::string text;
  for (const HeadCheckRecord& each : records) text += lineOf(each);
  base::writeFileAtomically(path, text);
  return records;
}

std::array<double, kFollowedDrifts> effectsAtRim(const Eigen::AlignedBox2d& field_W_mm) {
  const Eigen::Vector2d reach = field_W_mm.min().cwiseAbs().cwiseMax(field_W_mm.max().cwiseAbs());
  return {1.0, 1.0, reach.x(), reach.y(), reach.norm()};
}

bool DriftTrend::drifts() const { return std::abs(per_month) > U_per_month; }

std::optional<DriftTrend> trendOf(const std::vector<HeadCheckRecord>& records, std::size_t drift,
                                  double effect_mm, double limit_mm) {
  std::vector<double> days, values, sigmas;
  for (const HeadCheckRecord& record : records) {
    days.push_back(calibrate::dayNumber(record.date).value() -
                   calibrate::dayNumber(records.front().date).value());
    values.push_back(record.drifts[drift].value);
    sigmas.push_back(0.5 * record.drifts[drift].U);
  }
  if (days.size() < kLeastChecks || std::set<double>(days.begin(), days.end()).size() < 2)
    return std::nullopt;
  const Line line = lineThrough(days, values, sigmas);
  DriftTrend trend{.checks = days.size(),
                   .per_month = kDaysPerMonth * line.b,
                   .U_per_month = 2.0 * kDaysPerMonth * std::sqrt(line.bb),
                   .may_day = std::nullopt,
                   .likely_day = std::nullopt,
                   .first_value = line.a,
                   .first_day = calibrate::dayNumber(records.front().date).value()};
  const int last = static_cast<int>(days.back());
  for (int t = last; t <= last + kFarthest_days && !trend.likely_day; ++t) {
    const double effect = effect_mm * std::abs(line.at(t)), U = 2.0 * effect_mm * line.sigmaAt(t);
    if (!trend.may_day && effect + U >= limit_mm) trend.may_day = trend.first_day + t;
    if (effect >= limit_mm) trend.likely_day = trend.first_day + t;
  }
  return trend;
}

}  // namespace kerfbench::head_service
