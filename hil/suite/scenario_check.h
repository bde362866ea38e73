// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

namespace kerfbench::suite {

/// A scenario as a run of the suite would read it.
struct CheckedScenario {
  std::string name;
  std::string title;
  bool on_real_pins{};
  std::map<std::filesystem::path, std::string> files{};  ///< All files on which the run depends -> SHA-256.
};

/// What came of reading a scenario.
struct ScenarioAnswer {
  enum class Fault {
    kNone,
    kScenario,  ///< Each line of `why` begins with a file and, where it is known, a line.
    kLimits,    ///< The limits that were put in are at fault; each line of `why` begins with a key.
    kImage,     ///< The image does not fit the controller; `why` is a sentence. `scenario` is set as well.
  };
  Fault fault{Fault::kNone};
  std::string why{};
  CheckedScenario scenario{};  ///< Set where neither scenario nor limits are at fault.
};

/// Reads scenarios with all files that they name, each combination once.
class ScenarioChecks {
 public:
  /// `bin_dir`: where kerfbench's children are.
  explicit ScenarioChecks(std::filesystem::path bin_dir) : bin_dir_(std::move(bin_dir)) {}

  /// The scenario with another image and other limits, both may be empty (see limitedScenario()).
  const ScenarioAnswer& check(const std::filesystem::path& scenario, const std::filesystem::path& image,
                              const std::map<std::string, std::string>& limits);

 private:
  [[nodiscard]] ScenarioAnswer answerTo(const std::filesystem::path& scenario,
                                        const std::filesystem::path& image, const std::string& limited);

  std::filesystem::path bin_dir_;
  std::map<std::string, ScenarioAnswer> answers_;
  std::map<std::filesystem::path, std::string> sums_;  ///< SHA-256 of files that were read.
};

/// A scenario that extends another one by limits: keys of `checks`, those in sections with dots between.
std::string limitedScenario(const std::filesystem::path& scenario,
                            const std::map<std::string, std::string>& limits);

}  // namespace kerfbench::suite
