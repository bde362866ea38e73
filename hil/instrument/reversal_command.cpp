// SPDX-License-Identifier: Apache-2.0
#include "hil/instrument/reversal_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/version.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/head/rigid.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/camera/tile_folder.h"
#include "hil/head_service/head_procedure.h"
#include "hil/head_service/sheet_on_twin.h"
#include "hil/head_service/turned_view.h"
#include "hil/instrument/head_exit.h"
#include "hil/scenario/scenario.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::instrument {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Json = nlohmann::ordered_json;

constexpr int kReversalSheet = 2000;   // Number of a sheet whose pictures have a noise of their own.
constexpr double kFieldBorder_mm = 1;  // Around the marks.
constexpr double kToldSigmas = 4.0;  // Sigmas beyond which one of 16 terms lies by chance once in a thousand.
constexpr double kRough =
    2.0;  // Scatter over what pictures say from which on the camera's error is not smooth.

head_service::TwinBench benchOf(const ReversalCommandOptions& options) {
  return {.seed = options.seed,
          .imperfections = scenario::presetFromName(options.imperfections),
          .fidelity = scenario::fidelityFromName(options.twin),
          .bin_dir = options.bin_dir,
          .keep_pictures = options.keep_pictures,
          .threads = options.jobs};
}

std::vector<double> turnsOf(const ReversalCommandOptions& options) {
  std::vector<double> turns{0.0};
  turns.insert(turns.end(), options.turns_deg.begin(), options.turns_deg.end());
  return turns;
}

/// A sheet, and how it was seen.
struct Seen {
  calibrate::MarkJob job;
  std::vector<head_service::TurnedView> views;
};

Seen onTwin(const head_service::HeadSetup& setup, const ReversalCommandOptions& options,
            base::Console& console) {
  const head_service::TwinBench bench = benchOf(options);
  head_service::HeadPlan plan;
  plan.date = setup.camera.date;
  const calibrate::MarkJob planned = head_service::planSheet(
      setup, plan, "reversal", calibrate::gridPlaces(setup.field_W_mm, options.grid), 0);
  const head_service::SheetRequest request{planned, kReversalSheet, options.results_dir / planned.name,
                                           setup.table_file};
  const scenario::Case test_case = head_service::sheetCase(setup, bench, request);
  const auto progress = base::progressOn(console);
  run::CutSheet cut = head_service::cutSheet(test_case, bench, planned.name, progress);
  // The job as its file rounds it: so that the pictures alone tell the same later.
  Seen seen{calibrate::readMarkJob(request.folder / head_service::kSheetJob), {}};
  int sheet = kReversalSheet;
  for (const double turn_deg : turnsOf(options)) {
    progress(-1.0, fmt::format("photographing the sheet, turned by {:g}°", turn_deg));
    const auto tiles = [&] {
      return head_service::sheetPictures(setup, bench, test_case, cut, sheet,
                                         turn_deg * std::numbers::pi / 180.0);
    };
    if (options.keep_pictures) {
      auto source = tiles();
      camera::writeTiles(source, request.folder / fmt::format("pictures-{:g}", turn_deg));
    }
    auto source = tiles();
    const std::size_t count = source.size();
    seen.views.push_back(head_service::lookAt(source, count, seen.job, turn_deg, setup, options.jobs));
    ++sheet;
  }
  return seen;
}

Seen fromPictures(const head_service::HeadSetup& setup, const ReversalCommandOptions& options) {
  const std::vector<double> turns = turnsOf(options);
  if (options.pictures.size() != turns.size()) {
    throw base::ConfigError(
        fmt::format("{} folders of pictures for {} views: --pictures takes the first as the sheet lies, "
                    "then one for each of --turns",
                    options.pictures.size(), turns.size()));
  }
  Seen seen{head_service::readJobOf(setup, options.job), {}};
  for (std::size_t i = 0; i < turns.size(); ++i) {
    camera::TileFolder tiles = head_service::openPictures(setup, options.pictures[i]);
    seen.views.push_back(head_service::lookAt(tiles, tiles.size(), seen.job, turns[i], setup, options.jobs));
  }
  return seen;
}

calibrate::ReversalResult separated(const Seen& seen) {
  std::vector<calibrate::SheetView> views;
  calibrate::ReversalOptions options;
  for (const head_service::TurnedView& view : seen.views) {
    views.push_back(view.marks);
    for (const calibrate::SeenMark& mark : view.marks.marks) options.camera_field_mm.extend(mark.p_mm);
  }
  const Vector2d border = Vector2d::Constant(kFieldBorder_mm);
  options.camera_field_mm = {options.camera_field_mm.min() - border, options.camera_field_mm.max() + border};
  return calibrate::separateCamera(views, options);
}

/// What is whose, over the marks of the first view.
struct Shares {
  double camera_mm{}, camera_sigma_mm{};  ///< Largest, and its standard deviation in the worst direction.
  double head_mm{};                       ///< Largest, the camera's part taken off.
  double both_mm{};                       ///< As the first view shows it.
  std::vector<std::pair<int, Vector2d>> head;  ///< Sorted by number.
};

Shares sharesOf(const Seen& seen, const calibrate::ReversalResult& result) {
  const head_service::TurnedView& first = seen.views.front();
  Shares shares;
  std::map<int, Vector2d> wanted_S;
  for (const calibrate::WantedMark& mark : seen.job.marks)
    wanted_S.emplace(mark.number, seen.job.wanted_S_mm(mark));
  for (const calibrate::SeenMark& mark : first.marks.marks) {
    const Vector2d camera_mm = result.camera.at_mm(mark.p_mm);
    if (camera_mm.norm() >= shares.camera_mm) {
      const SymmetricEigen<2> spread(result.camera.covarianceAt_mm2(mark.p_mm));
      shares.camera_mm = camera_mm.norm();
      shares.camera_sigma_mm = std::sqrt(spread.values.maxCoeff());
    }
    shares.both_mm =
        std::max(shares.both_mm, (first.X_TS.inverse() * mark.p_mm - wanted_S.at(mark.id)).norm());
  }
  // The printed marks were seen by the same camera.
  std::vector<calibrate::PlacePair> print;
  for (const RegistrationMark& mark : seen.job.print) {
    const Vector2d p_T = first.X_TS * mark.p_SM_mm;
    print.emplace_back(mark.p_SM_mm, p_T - result.camera.at_mm(p_T));
  }
  const Eigen::Isometry2d X_ST = calibrate::rigidMotion(print).X.inverse();
  for (const calibrate::SeenMark& mark : result.marks) {
    const Vector2d error_mm = X_ST * mark.p_mm - wanted_S.at(mark.id);
    shares.head.emplace_back(mark.id, error_mm);
    shares.head_mm = std::max(shares.head_mm, error_mm.norm());
  }
  return shares;
}

std::string reversalJson(const Seen& seen, const calibrate::ReversalResult& result, const Shares& shares,
                         const head_service::HeadSetup& setup, const std::string& command) {
  Json json{{"version", 1},
            {"kerfbench", base::version()},
            {"machine", setup.name},
            {"camera", setup.camera.camera_id},
            {"camera_mm", shares.camera_mm},
            {"camera_sigma_mm", shares.camera_sigma_mm},
            {"head_mm", shares.head_mm},
            {"first_view_mm", shares.both_mm},
            {"rejected", result.rejected},
            {"noise_ratio", result.noise_ratio}};
  for (const head_service::TurnedView& view : seen.views)
    json["views"].push_back(
        {{"name", view.marks.name}, {"pictures", view.pictures}, {"marks", view.marks.marks.size()}});
  for (const calibrate::CameraError::Term& term : result.camera.terms()) {
    json["terms"].push_back({{"name", term.name},
                             {"degree", term.degree},
                             {"value_mm", term.value_mm},
                             {"sigma_mm", term.sigma_mm},
                             {"held", term.held}});
  }
  for (const auto& [number, error_mm] : shares.head)
    json["head"].push_back({{"number", number}, {"off_mm", {error_mm.x(), error_mm.y()}}});
  json["command"] = command;
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

void tell(const Seen& seen, const calibrate::ReversalResult& result, base::Console& console) {
  for (const head_service::TurnedView& view : seen.views) {
    console.say(fmt::format("  {}: {} marks in {} picture{}", view.marks.name, view.marks.marks.size(),
                            view.pictures, view.pictures == 1 ? "" : "s"));
    for (const std::string& remark : view.remarks) console.say("    " + remark);
  }
  console.say("  the camera's error at the rim of what it sees:");
  std::vector<std::string> open;
  for (const calibrate::CameraError::Term& term : result.camera.terms()) {
    if (term.held)
      console.say(fmt::format("    {:<12} {:+.5f} ± {:.5f} mm", term.name, term.value_mm, term.sigma_mm));
    else
      open.push_back(term.name);
  }
  if (!open.empty()) console.say(fmt::format("    not told by these views: {}", fmt::join(open, "; ")));
  console.say("    a common scale no turning shows: that is the calibration target's matter");
  const bool tiles =
      std::ranges::any_of(seen.views, [](const head_service::TurnedView& view) { return view.pictures > 1; });
  if (tiles)
    console.say(
        "    a view is of several pictures: what is told is of the table that carries the camera, smooth "
        "over the sheet;\n"
        "    what the lens does within a picture is not");
  if (result.noise_ratio > kRough)
    console.say(fmt::format(
        "    the views differ by {:.1f} times what their pictures explain: the error is not smooth, or "
        "the sheet was bent",
        result.noise_ratio));
}

/// Terms beyond doubt, the largest first. The common scale is never among them.
std::string toldTerms(const calibrate::CameraError& camera) {
  std::vector<calibrate::CameraError::Term> told;
  for (const calibrate::CameraError::Term& term : camera.terms()) {
    if (term.held && std::abs(term.value_mm) > kToldSigmas * term.sigma_mm) told.push_back(term);
  }
  std::ranges::sort(told, std::greater{},
                    [](const calibrate::CameraError::Term& term) { return std::abs(term.value_mm); });
  std::vector<std::string> words;
  for (const calibrate::CameraError::Term& term : told) words.push_back(term.name);
  return fmt::format("{}", fmt::join(words, ", "));
}

int reversal(const ReversalCommandOptions& options) {
  base::Console console(options.quiet);
  const head_service::HeadSetup setup = head_service::readHeadSetup(options.machine, kDensest, options.table);
  fs::create_directories(options.results_dir);
  console.say(fmt::format("head of {}, kerf camera {}", setup.name, setup.camera.camera_id));
  const Seen seen = options.job.empty() ? onTwin(setup, options, console) : fromPictures(setup, options);
  const calibrate::ReversalResult result = separated(seen);
  const Shares shares = sharesOf(seen, result);
  tell(seen, result, console);
  base::writeFileAtomically(options.results_dir / "reversal.json",
                            reversalJson(seen, result, shares, setup, options.command_line));
  const std::string terms = toldTerms(result.camera);
  console.result(terms.empty()
                     ? fmt::format("{}: no error of the camera that these views could tell; the head is off "
                                   "by {:.4f} mm at most",
                                   setup.name, shares.head_mm)
                     : fmt::format("{}: the camera sees marks off by up to {:.4f} mm ({}); without that the "
                                   "head is off by {:.4f} mm "
                                   "at most, where the first view shows {:.4f} mm",
                                   setup.name, shares.camera_mm, terms, shares.head_mm, shares.both_mm));
  return 0;
}

}  // namespace

int reversalCommand(const ReversalCommandOptions& options) {
  return guardedHead(options.machine, "nothing is said of camera and head",
                     [&] { return reversal(options); });
}

}  // namespace kerfbench::instrument
