// SPDX-License-Identifier: Apache-2.0
// Long run of S0: thousands of pieces in both regimes, on the fast twin. An hour or two for ten thousand.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "tests/validation/strip_record.h"

namespace kerfbench::validation {
namespace {

int cutStrip(int argc, char** argv) {
  CLI::App app{"Cuts a strip of 800 mm into pieces of 1200 mm (Hu, Hu, Jiang 2014) and times the pieces."};
  int pieces = 100;
  std::string regime;
  std::string write;
  bool reference = false;
  app.add_option("--pieces", pieces, "How many")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--regime", regime, "Only this one")->check(CLI::IsMember({"continuous", "stop-and-go"}));
  app.add_flag("--reference", reference, "The reference solver instead of the fast one");
  app.add_option("--write", write, "Write the figures here as well");
  CLI11_PARSE(app, argc, argv);

  std::vector<int> marks;
  for (int mark = 1; mark < pieces; mark *= 10) marks.push_back(mark);
  marks.push_back(pieces);
  const auto machine = stripMachine(KERFBENCH_SOURCE_DIR);
  std::vector<StripFigure> all;
  for (const auto each : {StripJob::Regime::kStopAndGo, StripJob::Regime::kContinuous}) {
    if (!regime.empty() && regime != nameOf(each)) continue;
    StripJob job;
    job.regime = each;
    const auto fidelity = reference ? twin::Fidelity::kReference : twin::Fidelity::kFast;
    const auto tell = [&job](const StripFigure& figure) {
      fmt::print(
          "{}: piece {} after {:.5f} s, formula {:.3f} s, ramps {:.5f} s; off its line by {:.4f} mm, {:.3f} "
          "mm "
          "unlit, {} KiB\n",
          nameOf(job.regime), figure.pieces, figure.cut_s, job.formula_s(figure.pieces),
          job.ramps_s(figure.pieces), figure.worst_mm, figure.unlit_mm, figure.peak_kib);
      std::fflush(stdout);
    };
    const auto figures = cutPieces(machine, job, fidelity, marks, tell);
    all.insert(all.end(), figures.begin(), figures.end());
  }
  if (!write.empty()) writeFigures(write, all);
  return 0;
}

}  // namespace
}  // namespace kerfbench::validation

int main(int argc, char** argv) {
  try {
    return kerfbench::validation::cutStrip(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "kerfbench-strip: {}\n", e.what());
    return 2;
  }
}
