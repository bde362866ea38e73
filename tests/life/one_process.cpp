// SPDX-License-Identifier: Apache-2.0
// Runs of a scenario one after the other in one process, for `./bench life`: after each a line of what the
// process has.
#include <sys/resource.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "hil/app/run_command.h"
#include "hil/base/file_content.h"
#include "hil/base/freed_memory.h"
#include "hil/base/stopwatch.h"
#include "tests/life/heap_count.h"

namespace kerfbench::life {
namespace {

namespace fs = std::filesystem;

/// CPU time of this process and of the releases that it has run, s.
double cpu_s() {
  double sum_s = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    getrusage(who, &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime})
      sum_s += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  }
  return sum_s;
}

/// A figure of /proc/self/status, e.g. "VmRSS:" in KiB.
long long status(const std::string& name) {
  const std::string text = base::fileContent("/proc/self/status").value_or("");
  const std::size_t at = text.find(name);
  return at == std::string::npos ? -1 : std::strtoll(text.c_str() + at + name.size(), nullptr, 10);
}

int runMany(int runs, const fs::path& scenario, const fs::path& results) {
  judge::RunOptions options;
  options.results_dir = results;
  options.twin = "fast";
  options.jobs = 2;
  options.quiet = true;
  options.pictures = false;
  options.bin_dir = fs::path(KERFBENCH_BINARY_DIR) / "bin";
  std::puts("run,cpu_s,heap_bytes,heap_peak_bytes,rss_kib,descriptors,threads");
  for (int run = 1; run <= runs; ++run) {
    const double begun_s = cpu_s();
    restartPeak();
    const int code = app::runCommand({scenario}, {}, options);
    if (code != 0)
      throw std::runtime_error("run " + std::to_string(run) + " ends with " + std::to_string(code));
    const HeapCount heap = heapCount();
    std::printf("%d,%.3f,%zu,%zu,%lld,%zu,%lld\n", run, cpu_s() - begun_s, heap.now, heap.peak,
                status("VmRSS:"), openDescriptors(), status("Threads:"));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace kerfbench::life

int main(int argc, char** argv) {
  kerfbench::base::keepFreedMemory();
  int runs = 0;
  if (argc != 4 || std::from_chars(argv[1], argv[1] + std::strlen(argv[1]), runs).ec != std::errc() ||
      runs < 1) {
    std::fputs("usage: kerfbench-life RUNS SCENARIO RESULTS\n", stderr);
    return 64;
  }
  try {
    return kerfbench::life::runMany(runs, argv[2], argv[3]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "kerfbench-life: %s\n", e.what());
    return 2;
  }
}
