// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/head_claims.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

namespace kerfbench::test {
namespace {

constexpr std::size_t kEnoughSeeds = 10;

double shareOf(const CalibratedHead& head) {
  return static_cast<double>(head.covered) / static_cast<double>(head.places);
}

void brokenOf(const HeadKindProof& kind, std::vector<std::string>& broken) {
  for (const CalibratedHead& head : kind.heads) {
    const std::string who = fmt::format("{}, seed {}", kind.machine, head.seed);
    if (!head.error.empty()) {
      broken.push_back(fmt::format("{}: {}", who, head.error));
      continue;
    }
    if (head.max_mm > kind.limit_mm) {
      broken.push_back(fmt::format("{}: off by {:.1f} um, the limit is {:g}", who, 1e3 * head.max_mm,
                                   1e3 * kind.limit_mm));
    }
    if (head.max_mm <= kind.limit_mm && head.most_mm() > kind.limit_mm) {
      broken.push_back(
          fmt::format("{}: {:.1f} ± {:.1f} um anywhere are not proven to be within the limit of {:g}", who,
                      1e3 * head.largest_mm, 1e3 * head.U_mm, 1e3 * kind.limit_mm));
    }
    if (head.iterations > kMostIterations)
      broken.push_back(fmt::format("{}: {} iterations", who, head.iterations));
  }
}

void brokenCover(const std::vector<CalibratedHead>& heads, int iterations, std::vector<std::string>& broken) {
  const Cover cover = coverOf(heads);
  const bool fine =
      cover.share + 2.0 * cover.sigma >= kLeastCover && cover.share - 2.0 * cover.sigma <= kMostCover;
  if (cover.seeds < kEnoughSeeds || fine) return;
  broken.push_back(
      fmt::format("after {} iteration{} the ellipse of 95 % holds {:.1f} ± {:.1f} % of the places of {} "
                  "heads of {} seeds; {:g} … {:g} % are claimed",
                  iterations, iterations == 1 ? "" : "s", 100.0 * cover.share, 200.0 * cover.sigma,
                  cover.heads, cover.seeds, 100.0 * kLeastCover, 100.0 * kMostCover));
}

std::string rowOf(const HeadKindProof& kind) {
  double least_raw = INFINITY, raw = 0.0, max = 0.0, rms = 0.0, wall_s = 0.0;
  int iterations = 0;
  std::size_t good = 0;
  for (const CalibratedHead& head : kind.heads) {
    if (!head.error.empty()) continue;
    least_raw = std::min(least_raw, head.raw_mm);
    raw = std::max(raw, head.raw_mm);
    max = std::max(max, head.max_mm);
    rms = std::max(rms, head.rms_mm);
    wall_s = std::max(wall_s, head.wall_s);
    iterations = std::max(iterations, head.iterations);
    if (std::max(head.max_mm, head.most_mm()) <= kind.limit_mm && head.iterations <= kMostIterations) ++good;
  }
  const Cover cover = coverOf(kind.heads);
  return fmt::format(
      "{:<20} {:>6.2f} {:>6.2f} {:>5} {:>8.2f} {:>6g} {:>7.2f} {:>7.1f} {:>5.1f} {:>7.1f} {:>6}/{}\n",
      kind.machine, least_raw, raw, iterations, 1e3 * max, 1e3 * kind.limit_mm, 1e3 * rms,
      100.0 * cover.share, 100.0 * cover.sigma, wall_s, good, kind.heads.size());
}

}  // namespace

Cover coverOf(const std::vector<CalibratedHead>& heads) {
  Cover cover;
  for (const CalibratedHead& head : heads) {
    if (!head.error.empty() || head.places == 0) continue;
    ++cover.heads;
    cover.share += shareOf(head);
  }
  if (cover.heads == 0) return cover;
  const auto n = static_cast<double>(cover.heads);
  cover.share /= n;
  std::map<std::uint64_t, double> off;  // Differences from the mean, of all heads of a seed.
  for (const CalibratedHead& head : heads) {
    if (head.error.empty() && head.places > 0) off[head.seed] += shareOf(head) - cover.share;
  }
  cover.seeds = off.size();
  double sum = 0.0;
  for (const auto& [seed, of_seed] : off) sum += of_seed * of_seed;
  const auto seeds = static_cast<double>(cover.seeds);
  if (cover.seeds > 1) cover.sigma = std::sqrt(seeds / (seeds - 1.0) * sum) / n;
  return cover;
}

std::vector<std::string> brokenClaims(const std::vector<HeadKindProof>& proof) {
  std::vector<std::string> broken;
  std::vector<CalibratedHead> all;
  for (const HeadKindProof& kind : proof) {
    brokenOf(kind, broken);
    all.insert(all.end(), kind.heads.begin(), kind.heads.end());
  }
  for (int iterations = 1; iterations <= kMostIterations; ++iterations) {
    std::vector<CalibratedHead> alike;
    std::ranges::copy_if(all, std::back_inserter(alike),
                         [&](const CalibratedHead& head) { return head.iterations == iterations; });
    brokenCover(alike, iterations, broken);
  }
  return broken;
}

std::string tableOf(const std::vector<HeadKindProof>& proof) {
  std::string table =
      fmt::format("{:<20} {:>13} {:>5} {:>8} {:>6} {:>7} {:>13} {:>7} {:>6}\n", "head", "raw, mm", "iter.",
                  "max, um", "limit", "RMS, um", "cover, %", "time, s", "hold");
  for (const HeadKindProof& kind : proof) table += rowOf(kind);
  return table;
}

std::string csvOf(const std::vector<HeadKindProof>& proof) {
  std::string csv = "machine,seed,raw_mm,iterations,max_mm,rms_mm,largest_mm,U_mm,places,covered,error\n";
  for (const HeadKindProof& kind : proof) {
    for (const CalibratedHead& h : kind.heads) {
      std::string error = h.error;
      std::ranges::replace_if(
          error, [](char c) { return c == ',' || c == '\n' || c == '"'; }, ' ');
      csv += fmt::format("{},{},{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f},{},{},{}\n", kind.machine, h.seed,
                         h.raw_mm, h.iterations, h.max_mm, h.rms_mm, h.largest_mm, h.U_mm, h.places,
                         h.covered, error);
    }
  }
  return csv;
}

}  // namespace kerfbench::test
