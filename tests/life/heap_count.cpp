// SPDX-License-Identifier: Apache-2.0
#include "tests/life/heap_count.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <iterator>

// glibc's own, which remain when malloc() is replaced (glibc manual, 3.2.5).
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}

namespace kerfbench::life {
namespace {

constinit std::atomic<std::size_t> bytes_now{0};
constinit std::atomic<std::size_t> bytes_peak{0};

void* counted(void* block) {
  if (block == nullptr) return block;
  const std::size_t size = malloc_usable_size(block);
  const std::size_t now = bytes_now.fetch_add(size, std::memory_order_relaxed) + size;
  std::size_t peak = bytes_peak.load(std::memory_order_relaxed);
  while (now > peak && !bytes_peak.compare_exchange_weak(peak, now, std::memory_order_relaxed)) {
  }
  return block;
}

void uncount(void* block) {
  if (block != nullptr) bytes_now.fetch_sub(malloc_usable_size(block), std::memory_order_relaxed);
}

}  // namespace

HeapCount heapCount() { return {bytes_now.load(), bytes_peak.load()}; }

void restartPeak() { bytes_peak = bytes_now.load(); }

std::size_t openDescriptors() {
  const std::filesystem::directory_iterator open("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(open), end(open))) - 1;
}

}  // namespace kerfbench::life

// NOLINTBEGIN(cppcoreguidelines-no-malloc,readability-inconsistent-declaration-parameter-name)
extern "C" {

void* malloc(std::size_t size) { return kerfbench::life::counted(__libc_malloc(size)); }

void* calloc(std::size_t count, std::size_t size) {
  return kerfbench::life::counted(__libc_calloc(count, size));
}

void* realloc(void* block, std::size_t size) {
  const std::size_t before = block == nullptr ? 0 : malloc_usable_size(block);
  void* const moved = __libc_realloc(block, size);
  if (moved == nullptr && size > 0) return moved;  // The block is where it was.
  kerfbench::life::bytes_now.fetch_sub(before, std::memory_order_relaxed);
  return kerfbench::life::counted(moved);
}

void* memalign(std::size_t alignment, std::size_t size) {
  return kerfbench::life::counted(__libc_memalign(alignment, size));
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) {
  kerfbench::life::uncount(block);
  __libc_free(block);
}

}  // extern "C"
// NOLINTEND(cppcoreguidelines-no-malloc,readability-inconsistent-declaration-parameter-name)
