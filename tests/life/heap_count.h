// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace kerfbench::life {

/// Bytes of the heap, counted in malloc() and free() of the program that links heap_count.cpp, so that
/// Eigen's and all libraries' are among them. Not counted: memory that is mapped by mmap(), and what malloc()
/// itself keeps. For glibc, and not beside a sanitizer, which has its own malloc().
struct HeapCount {
  std::size_t now{};   ///< In use.
  std::size_t peak{};  ///< Most since restartPeak().
};

HeapCount heapCount();
/// The peak begins again at what is in use now.
void restartPeak();

/// Descriptors that this process has open, those that are used for counting them left out.
std::size_t openDescriptors();

}  // namespace kerfbench::life
