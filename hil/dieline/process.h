// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

namespace kerfbench::dieline {

struct Dieline;  // Defined in hil/dieline/geometry.h.
/// A drawing with nothing in it.
std::shared_ptr<const Dieline> emptyDieline();

/// Process of the laser along an entity.
enum class Process { kCut, kHalfCut, kCrease, kPerforation, kIgnore };
std::string_view processName(Process process);

}  // namespace kerfbench::dieline
