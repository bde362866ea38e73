// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/progress.h"
#include "hil/campaign/campaign_file.h"
#include "hil/campaign/record.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::campaign {

/// A folder of results, made ready for the runs of one campaign.
struct Prepared {
  std::filesystem::path folder;  ///< Absolute.
  std::string identity;          ///< SHA-256 over bench, campaign file and all files that its runs depend on.

  [[nodiscard]] std::filesystem::path scenarios() const { return folder / "scenarios"; }
  [[nodiscard]] std::filesystem::path scenarioOf(std::size_t run) const;
  [[nodiscard]] RecordFolder records() const { return {folder / "records", identity}; }
};

/// What the results depend on besides the files that the runs name.
struct BenchFiles {
  scenario::ImagePath images;
  std::vector<std::filesystem::path> programs;  ///< Programs that run; what is not there is left out.
};

/// Writes the scenarios of all runs, reads each with its machine as `kerfbench run` will, and puts down the
/// sums of all files that they depend on: campaign.json. Where a folder has that already, the files are held
/// against these sums and nothing is written; so all shards may begin at once.
/// `asked`: the folder of results, made if it is not there.
/// @throws base::ConfigError for runs that no reader accepts, each fault once, with file and line;
/// base::InputError if the folder holds something else, or files have changed since.
Prepared prepare(const Campaign& campaign, const std::filesystem::path& asked, const BenchFiles& bench,
                 const base::ProgressFn& progress = {});

/// What campaign.json of a folder says, for those who only read its records.
struct KnownCampaign {
  Prepared prepared;
  std::string name, title;
  std::size_t runs{};
};
/// `asked`: the folder of results. @throws base::InputError.
KnownCampaign knownCampaign(const std::filesystem::path& asked);

}  // namespace kerfbench::campaign
