// SPDX-License-Identifier: Apache-2.0
// kerfbench-head-pixels: heads with hidden faults, calibrated on the twin from pictures as `calibrate head`
// does it, as a table. Exit code 1 if a claim does not hold. Earlier results are not cut again.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "hil/base/atomic_file.h"
#include "hil/head_service/head_on_twin.h"
#include "tests/scenarios/head_claims.h"

namespace {

using namespace kerfbench;
using namespace kerfbench::test;
namespace fs = std::filesystem;

constexpr int kDensest = 17;  // Densest grid with marks as large as `calibrate head` cuts them.

struct Options {
  std::uint64_t first_seed{1}, seeds{10};
  std::string only;
  std::vector<int> grids{head_service::HeadPlan{}.grids};
  int verify{400};
  double unmodelled_share{1e-6};  // The twin's encoders and board are exact.
  int jobs{1};
  fs::path results_dir{"results/head-pixels"};
  fs::path bin_dir;
};

CalibratedHead calibrated(const HeadKindProof& kind, std::uint64_t seed, const Options& options) {
  CalibratedHead head;
  head.seed = seed;
  const auto start = std::chrono::steady_clock::now();
  try {
    head_service::HeadPlan plan;
    plan.grids = options.grids;
    plan.verify = options.verify;
    plan.limit_mm = kind.limit_mm;
    plan.seed = seed;
    head_service::HeadSetup setup = head_service::readHeadSetup(
        fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/machines" / (kind.machine + ".yaml"), kDensest);
    setup.unmodelled_share = options.unmodelled_share;
    plan.date = setup.camera.date;
    head_service::TwinBench bench;
    bench.seed = seed;
    bench.bin_dir = options.bin_dir;
    bench.threads = options.jobs;
    bool before = false;
    head_service::HeadOnTwin cut(setup, bench,
                                 options.results_dir / fmt::format("{}-{}", kind.machine, seed));
    cut.was_there = [&](const std::string& /*sheet*/) { before = true; };
    const head_service::HeadCalibration result =
        head_service::calibrateHead(setup, plan, cut, [](const head_service::HeadIteration&) {});
    const head_service::HeadIteration& best = result.iterations.at(result.best);
    head.raw_mm = result.iterations.front().before.max_mm;
    head.iterations = static_cast<int>(result.iterations.size());
    head.max_mm = best.after.max_mm;
    head.rms_mm = best.after.rms_mm;
    head.places = best.after.marks;
    head.covered = best.table.covered;
    head.largest_mm = best.table.largest.value_mm;
    head.U_mm = best.table.largest.U_mm;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (!before) head.wall_s = took.count();
  } catch (const std::exception& error) {
    head.error = error.what();
  }
  return head;
}

void tell(const std::string& machine, const CalibratedHead& head) {
  if (head.error.empty()) {
    std::printf(
        "%s, seed %llu: %.3f mm, then %.2f um at most, %.2f um RMS, %.2f ± %.2f um anywhere; %zu of %zu "
        "within "
        "the ellipse\n",
        machine.c_str(), static_cast<unsigned long long>(head.seed), head.raw_mm, 1e3 * head.max_mm,
        1e3 * head.rms_mm, 1e3 * head.largest_mm, 1e3 * head.U_mm, head.covered, head.places);
  } else {
    std::printf("%s, seed %llu: %s\n", machine.c_str(), static_cast<unsigned long long>(head.seed),
                head.error.c_str());
  }
  std::fflush(stdout);
}

int prove(const Options& options) {
  std::vector<HeadKindProof> proof;
  for (const auto& [machine, limit_mm] : {std::pair{"two-mirror-100", 0.010},
                                          {"two-mirror-300", 0.010},
                                          {"two-mirror-800", 0.025},
                                          {"f-theta-300-mounted", 0.010}}) {
    if (std::string(machine).find(options.only) == std::string::npos) continue;
    HeadKindProof kind{machine, limit_mm, {}};
    for (std::uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
      kind.heads.push_back(calibrated(kind, seed, options));
      tell(machine, kind.heads.back());
    }
    proof.push_back(std::move(kind));
  }
  fs::create_directories(options.results_dir);
  base::writeFileAtomically(options.results_dir / "heads.csv", csvOf(proof));
  std::printf("\n%s", tableOf(proof).c_str());
  const std::vector<std::string> broken = brokenClaims(proof);
  for (const std::string& claim : broken) std::printf("DOES NOT HOLD: %s\n", claim.c_str());
  if (broken.empty()) std::printf("all claims hold\n");
  return broken.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Calibrates scan heads with hidden faults from pictures and tells what is left"};
  Options options;
  options.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  app.add_option("--seeds", options.seeds, "Heads of each machine")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "Of them")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--only", options.only, "Machines whose name holds this");
  app.add_option("--grids", options.grids,
                 "Marks each way of each iteration; ends where all is within the limit")
      ->delimiter(',')
      ->check(CLI::Range(3, 33))
      ->capture_default_str();
  app.add_option("--unmodelled-share", options.unmodelled_share,
                 "As `calibrate head` has it; by default what the twin's encoders and board do: nothing")
      ->check(CLI::Range(1e-9, 0.1))
      ->capture_default_str();
  app.add_option("--verify", options.verify, "Places that verify each table")
      ->check(CLI::Range(5, 1000))
      ->capture_default_str();
  app.add_option("--results-dir", options.results_dir, "Sheets, tables and heads.csv")->capture_default_str();
  app.add_option("--jobs,-j", options.jobs, "Threads; the result is the same at any number")
      ->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  options.bin_dir = fs::canonical("/proc/self/exe").parent_path();
  try {
    return prove(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
