// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kerfbench::compare {

/// What a larger value of a figure means.
enum class Better {
  kSmaller,   ///< A deviation, a time lost.
  kLarger,    ///< A margin, a share that is cut.
  kNearZero,  ///< A signed deviation.
  kNeither,   ///< A width: another value is neither better nor worse by itself.
};

/// One measured number of a run. Its place names it: equal places of two runs are compared.
struct Figure {
  enum class Of { kCheck, kEntity, kCut, kJoint };
  Of of{Of::kCheck};
  std::string place;     ///< "path"; "unit 0, E8"; "unit 0, E8, cut 2 along it"; "corner E3 to E4, unit 1".
  std::string quantity;  ///< Field of verdict.json, e.g. "worst_mm"; "value" of a check.
  std::string unit;      ///< "mm", "mm/s", "µs"; empty for counts and shares.
  double value{};
  /// Standard uncertainty, in the same unit; 0: none is stated, as for what is counted.
  double sigma{};
  Better better{Better::kSmaller};
};

/// A check's verdict, for those that were judged.
struct CheckVerdict {
  std::string verdict;  ///< "PASS", "NOT PROVEN", "FAIL", "INVALID".
  std::string subject;  ///< Where its value was found.
  double limit{};
  std::string unit;
};

/// What verdict.json of one run says, as far as runs are compared by it.
struct RunFigures {
  std::filesystem::path folder;
  std::string scenario, machine, firmware, firmware_sha256, firmware_version;
  std::string bench_version;
  std::string serial_number;  ///< Empty: none was given, or an older bench knew none.
  std::string verdict;
  std::string digest, inputs_digest;
  std::string imperfections, twin;
  std::uint64_t seed{};
  std::map<std::string, std::string> inputs;      ///< File as seen from the scenario -> SHA-256.
  std::map<std::string, CheckVerdict> checks;     ///< Keys are their names.
  std::map<std::string, std::string> not_judged;  ///< Checks that apply and were not judged -> why.
  std::vector<Figure> figures;                    ///< Each place and quantity once.
};

/// Whether the files of a folder are held against their list first, which reads all of them.
enum class Trust { kByItsSums, kAsItIs };

/// Reads the verdict of a results folder.
/// @throws base::InputError: no results folder; files that are not as its list has them; a verdict of another
/// version (`schema_version`), or one that lacks what this version promises. It names folder and fault.
RunFigures readRunFigures(const std::filesystem::path& folder, Trust trust = Trust::kByItsSums);

/// Rank for "got worse": PASS 0, NOT PROVEN 1, FAIL 2, INVALID 3.
int verdictRank(const std::string& verdict);

}  // namespace kerfbench::compare
