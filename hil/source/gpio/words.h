// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerfbench::source {

/// Meaning of an errno of each step for people, and what they can do; for reader and doctor alike.
std::string openWords(const std::string& chip, int error);
std::string chipWords(const std::string& chip, int error);
std::string lineInfoWords(const std::string& chip, int error);
std::string takenWords(const std::string& chip, std::uint32_t offset, const std::string& name,
                       const std::string& consumer);
std::string requestWords(const std::string& chip, int error);
std::string outputWords(const std::string& chip, int error);
std::string readWords(const std::string& chip, int error);
std::string writeWords(const std::string& chip, int error);

}  // namespace kerfbench::source
