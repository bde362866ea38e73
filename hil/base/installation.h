// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace kerfbench::base {

/// Folders of a bench whose programs are in `bin_dir`. A built bench is SOURCE/build/PRESET/bin, an installed
/// one PREFIX/lib/kerfbench/bin: beside the programs both have the same folders, and what is shipped lies
/// three folders up, as SOURCE/fixtures or PREFIX/share/kerfbench. None of these folders need exist.

/// Scenarios, machines, drawings, materials, plans.
std::filesystem::path shippedData(const std::filesystem::path& bin_dir);
/// Pages of the reference (scenario.md, machine.md), which say what a key means.
std::filesystem::path referencePages(const std::filesystem::path& bin_dir);
/// Bundled pages of the window.
std::filesystem::path windowPages(const std::filesystem::path& bin_dir);

/// Whether the bench is installed: advice to build something is no help then.
bool isInstalled(const std::filesystem::path& bin_dir);

}  // namespace kerfbench::base
