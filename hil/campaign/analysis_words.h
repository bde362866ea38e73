// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/campaign/analysis.h"

namespace kerfbench::campaign {

// Phrases that the page and the terminal share.

/// "12 of 40 (16.6 … 46.5 %)"
std::string shareWords(const RateRow& row);
/// "0.0123 (0.0101 … 0.0153)"
std::string sizeWords(const SizeEstimate& estimate);
/// The sizes that are found, or why there is no fit and what is known without.
std::string detectionWords(const Detection& detection);
/// "10 PASS, 2 FAIL, …"
std::string outcomeWords(const Outcomes& outcomes);
/// "0.031 ± 0.002 mm <= 0.05"
std::string marginWords(const CheckMargin& margin);

}  // namespace kerfbench::campaign
