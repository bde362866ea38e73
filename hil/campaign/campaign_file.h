// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"

namespace kerfbench::campaign {

/// A change of one key of a run's scenario, or of its machine, by the size of a fault or the value of a
/// factor.
struct Change {
  enum class How {
    kSet,    ///< `text`, in which the place holder stands for the size.
    kScale,  ///< What the base gives, times 1 + by · size.
    kShift,  ///< What the base gives, plus by · size.
  };
  bool of_machine{};  ///< A key of the machine file; else of the scenario.
  std::string key;    ///< With its sections: "belt.speed_mm_s".
  How how{How::kSet};
  std::string text;
  double by{};
};

/// Values that a factor or the size of a fault takes: a list, or a distribution that they are drawn from.
struct Values {
  enum class Kind { kList, kUniform, kLogUniform, kNormal };
  Kind kind{Kind::kList};
  std::vector<std::string> list;  ///< As written; not empty where it is a list.
  double min{}, max{};            ///< Bounds of what is drawn, min < max.
  double mean{}, sigma{};         ///< kNormal, before it is cut off at its bounds.

  [[nodiscard]] bool isDrawn() const { return kind != Kind::kList; }
};

/// One way in which a factor acts: by values, or the fault of one name by its sizes.
struct Kind {
  std::string name;              ///< Name of a fault; empty for the values of a factor.
  std::optional<Values> values;  ///< Absent for a fault without a size.
  std::vector<Change> changes;   ///< Empty for the fault "none".
};

/// Something that differs from run to run.
struct Factor {
  std::string name;
  bool is_fault{};          ///< The kinds are faults by name, of which a run has one.
  std::vector<Kind> kinds;  ///< One, without a name, unless it is a fault.
};

/// A key that is the same in all runs.
struct FixedKey {
  bool of_machine{};
  std::string key, text;
};

/// A campaign file, read and checked. docs/reference/campaign.md explains every key.
struct Campaign {
  std::filesystem::path path;
  std::string name, title;
  std::vector<std::filesystem::path> bases;  ///< Scenarios, absolute.
  std::vector<FixedKey> fixed;
  std::vector<Factor> factors;
  std::uint64_t seed{1};
  std::size_t draws{};     ///< So many runs, with all factors drawn; 0: the whole grid.
  std::size_t repeats{1};  ///< How often each point of the grid is run, with another seed each time.
  bool own_seeds{true};    ///< False where a factor or a fixed key is the scenario's `seed`.
  std::vector<std::filesystem::path> inputs;  ///< The file and what it extends, absolute.

  /// Number of runs.
  [[nodiscard]] std::size_t runs() const;
};

/// Most runs that a campaign may have.
inline constexpr std::size_t kMostRuns = 100'000;
/// In the text of a change: the size of a fault, the value of a factor.
inline constexpr const char* kSizeHolder = "{size}";
inline constexpr const char* kValueHolder = "{value}";

/// @throws base::ConfigError with every fault, each with file and line.
Campaign readCampaign(const std::filesystem::path& path);

/// The keys that the reader asked for in this file, for the reference page. @throws base::ConfigError.
std::vector<base::YamlReader::Asked> campaignKeys(const std::filesystem::path& path);

}  // namespace kerfbench::campaign
