// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hil/head_service/head_procedure.h"

namespace kerfbench::head_service {

/// Something that a service engineer does, or that the bench did with what he brought.
struct ServiceStep {
  enum class State { kDone, kNow, kLater };
  struct File {
    std::string path;  ///< From the results folder.
    std::string what;
  };
  std::string id;     ///< Unique, "1-grid.cut": the same from call to call.
  std::string sheet;  ///< Name of the sheet that it is about; empty: of none.
  std::string title;
  std::vector<std::string> text{};  ///< What is to be done, a sentence or two each.
  State state{State::kLater};
  std::vector<File> files{};
  std::vector<std::string> found{};  ///< What came of it.
  std::vector<std::string> wrong{};  ///< What is wrong with what was brought.
};
std::string_view nameOf(ServiceStep::State state);  ///< "done", "now", "later"

/// What the steps are of.
struct ServiceFacts {
  std::string kind;  ///< "calibrate head", "calibrate check"
  std::string machine;
  std::string camera;
  std::string date;
  std::string command;  ///< Command to run again after each sheet.
  std::string version;
};

/// Steps of a calibration or a check by hand, as far as they are known: those of each sheet in turn, then
/// those that follow. Data, for the page on paper and the window alike.
class ServiceSteps {
 public:
  ServiceSteps(ServiceFacts facts, std::filesystem::path results)
      : facts_(std::move(facts)), results_(std::move(results)) {}

  /// The sheet has no pictures yet; `cut`, `photograph`: what is to be done. `missing`: pictures that lack,
  /// where some are there.
  void wanted(const SheetOrder& order, const std::vector<std::string>& cut,
              const std::vector<std::string>& photograph, const std::vector<std::string>& missing);
  /// Pictures of the sheet cannot be used.
  void refused(const SheetOrder& order, const std::string& why);
  void measured(const SheetOrder& order, const MeasuredSheet& sheet);
  /// Steps behind the sheets, in place of those that stood there.
  void follow(std::vector<ServiceStep> steps) { following_ = std::move(steps); }
  /// In capitals; none as long as it goes on.
  void ended(std::string verdict, std::string headline);

  [[nodiscard]] const std::vector<ServiceStep>& sheets() const { return sheets_; }
  [[nodiscard]] std::string json() const;
  /// One self-contained page with boxes to tick, for a screen or for paper.
  [[nodiscard]] std::string html() const;
  /// Writes steps.json and steps.html into the results folder.
  void write() const;

 private:
  [[nodiscard]] std::vector<ServiceStep> all() const;
  [[nodiscard]] std::string headline() const;
  void addSheet(const SheetOrder& order, ServiceStep::State cut, ServiceStep::State load,
                ServiceStep::State found);

  ServiceFacts facts_;
  std::filesystem::path results_;
  std::vector<ServiceStep> sheets_, following_;
  std::string verdict_, headline_;
};

/// Text of the steps.json in a results folder, to be handed on as it is. @throws ConfigError for a folder
/// that has none, and for one that is not what this program writes.
std::string readSteps(const std::filesystem::path& results);

/// Steps that follow the sheets of `calibrate head`: as long as it goes on, and after it ended with this
/// table in the results folder.
std::vector<ServiceStep> stepsAhead();
std::vector<ServiceStep> stepsAfter(const HeadCalibration& result, const HeadPlan& plan,
                                    const std::string& table);

}  // namespace kerfbench::head_service
