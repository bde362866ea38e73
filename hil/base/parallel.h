// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace kerfbench::base {

/// Calls work(0) … work(count - 1), each once, on up to `threads` threads. Which thread takes which is left
/// to chance, so the calls must not depend on each other. If calls throw, the exception of the smallest index
/// is passed on.
void forEachIndex(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

}  // namespace kerfbench::base
