// SPDX-License-Identifier: Apache-2.0
// KERFBENCH_WIDE: compile a function for processors with wider registers too; which one runs is chosen when
// the program starts. For loops of whole numbers, or of floats each of which is computed by itself: the order
// of operations is the same and AVX2 alone brings no fused multiply-add, so the result is the same to the
// bit. Only for functions of one source: where a header declares a function without it, clang++ 14 compiles
// it for the usual registers alone, and says nothing.
#pragma once

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KERFBENCH_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KERFBENCH_SANITIZED
#endif

// A sanitizer is not there yet when the program's loader asks which one is to run.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(KERFBENCH_SANITIZED)
#define KERFBENCH_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define KERFBENCH_WIDE
#endif

// KERFBENCH_INTERLEAVED: before a loop whose rounds are long chains of operations: two registers full of them
// at a time, so that one does not wait for itself.
#if defined(__clang__)
#define KERFBENCH_INTERLEAVED _Pragma("clang loop interleave_count(2)")
#else
#define KERFBENCH_INTERLEAVED
#endif
