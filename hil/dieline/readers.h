// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "hil/dieline/faults.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {

inline constexpr std::size_t kMostEntities =
    1'000'000;                              ///< Also the limit of what nested blocks may unfold to.
inline constexpr int kDeepestNesting = 16;  ///< INSERT in INSERT, use in use.
inline constexpr std::size_t kLargestFile = 256U << 20U;  ///< Bytes.

/// Both take the whole text of a file; entities get their ids here. @throws DielineError
Dieline readDxf(std::string text, const LayerProfile& profile, FaultList& faults);
Dieline readSvg(const std::string& text, const LayerProfile& profile, FaultList& faults);

}  // namespace kerfbench::dieline
