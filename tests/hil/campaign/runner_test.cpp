// SPDX-License-Identifier: Apache-2.0
// Shards of runs that a script stands for: `kerfbench run` itself is in tests/campaigns.
#include "hil/campaign/runner.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/digest.h"
#include "hil/campaign/merge.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/compare/kept_verdict.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kRuns = 9;

class Runner : public testing::Test {
 protected:
  Runner() {
    campaign_.name = "c";
    campaign_.bases = {"/x/base.yaml"};
    campaign_.draws = kRuns;
    campaign_.factors = {{"speed",
                          false,
                          {{"",
                            Values{.kind = Values::Kind::kUniform, .min = 1, .max = 2},
                            {{.key = "belt.speed", .text = kValueHolder}}}}}};
    (void)folder_.write("verdict.json", compare::plainVerdict().dump());
  }

  /// A bench that leaves a verdict for each run, unless `special` does something else first: `run` is its
  /// number.
  fs::path bench(const std::string& special = "") {
    const fs::path file = folder_.write("bench.sh", "#!/bin/sh\nrun=$(basename \"$2\" .yaml)\n" + special +
                                                        "\nmkdir -p \"$4/c-$run/latest\"\ncp '" +
                                                        (folder_.path() / "verdict.json").string() +
                                                        "' \"$4/c-$run/latest/\"\n");
    fs::permissions(file, fs::perms::owner_all);
    return file;
  }
  Prepared prepared(const std::string& name, const std::string& identity = "an identity") const {
    return {folder_.path() / name, identity};
  }
  ShardEnd run(const Prepared& in, std::size_t shard, std::size_t shards, const std::string& special = "",
               int at_once = 2) {
    ShardOptions options{.shard = shard, .shards = shards, .at_once = at_once, .program = bench(special)};
    options.remark = [&](const std::string& remark) { remarks_ += remark + "\n"; };
    return runShard(campaign_, in, options);
  }
  std::string resultsIn(const Prepared& in) const { return base::contentOf(in.folder / "results.jsonl"); }

  base::TempFolder folder_;
  Campaign campaign_;
  std::string remarks_;
};

TEST_F(Runner, AnyNumberOfShardsMergesToTheSameBytes) {
  const Prepared whole = prepared("whole");
  EXPECT_EQ(run(whole, 1, 1, "", 1).made, kRuns);
  const Merged one = merge(whole, kRuns, false);
  ASSERT_EQ(one.records.size(), kRuns);
  const std::string bytes = resultsIn(whole);
  EXPECT_EQ(one.digest, base::sha256(bytes));
  EXPECT_EQ(std::ranges::count(bytes, '\n'), static_cast<std::ptrdiff_t>(kRuns));
  EXPECT_EQ(base::contentOf(whole.folder / "results.sha256"), one.digest + "  results.jsonl\n");
  for (const std::size_t shards : {3U, 7U}) {
    const Prepared in = prepared(std::to_string(shards));
    for (std::size_t s = shards; s >= 1; --s) EXPECT_THAT(run(in, s, shards).broken, IsEmpty());
    EXPECT_EQ(merge(in, kRuns, false).digest, one.digest);
    EXPECT_EQ(resultsIn(in), bytes);
  }
}

TEST_F(Runner, AShardThatWasInterruptedOrMadeTwiceChangesNothing) {
  const Prepared whole = prepared("whole"), in = prepared("in");
  (void)run(whole, 1, 1);
  const std::string digest = merge(whole, kRuns, false).digest;
  (void)run(in, 2, 3);
  // A node dies in mid-run: what it was at is left, and no record of it.
  fs::create_directories(in.folder / "runs" / "node7-abc" / "first" / "000003");
  (void)folder_.write("in/records/000/.000003.json.Xy12Zw", "{\"run\":3,\"ba");
  EXPECT_FALSE(merge(in, kRuns, false).isWhole());
  EXPECT_FALSE(fs::exists(in.folder / "results.jsonl"));
  const ShardEnd rest = run(in, 1, 1);
  EXPECT_EQ(rest.had, indicesOf(kRuns, 2, 3).size());
  EXPECT_EQ(rest.made, kRuns - rest.had);
  EXPECT_EQ(run(in, 1, 3).made, 0U);
  EXPECT_EQ(merge(in, kRuns, false).digest, digest);
  sweep(in);
  EXPECT_FALSE(fs::exists(in.folder / "runs"));
}

TEST_F(Runner, MissingRunsKeepAMergeFromBeingWholeAndAreNamed) {
  const Prepared in = prepared("in");
  (void)run(in, 1, 2);
  const Merged merged = merge(in, kRuns, true);
  EXPECT_EQ(merged.missing, indicesOf(kRuns, 2, 2));
  EXPECT_EQ(std::ranges::count(resultsIn(in), '\n'), 5);
  EXPECT_EQ(rangesOf({0, 1, 2, 5, 7, 8}), "0-2, 5, 7-8");
  EXPECT_THAT(rangesOf({0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22}), HasSubstr("18 and 2 more"));
}

TEST_F(Runner, ADamagedRecordIsNamedAndMadeAgain) {
  const Prepared in = prepared("in");
  (void)run(in, 1, 1);
  const std::string digest = merge(in, kRuns, false).digest;
  const RecordFolder records = in.records();
  const std::string good = base::contentOf(records.fileOf(4));
  const auto damage = [&](std::size_t run_, const std::string& content) {
    (void)folder_.write(fs::relative(records.fileOf(run_), folder_.path()).string(), content);
  };
  damage(4, base::replaced(good, "PASS", "FAIL"));
  damage(5, good.substr(0, good.size() / 2));
  damage(6, "");
  damage(7, good);
  const Merged merged = merge(in, kRuns, false);
  EXPECT_EQ(merged.missing, (std::vector<std::size_t>{4, 5, 6, 7}));
  ASSERT_EQ(merged.damaged.size(), 4U);
  EXPECT_THAT(merged.damaged[0], HasSubstr(records.fileOf(4).string() + ": is not as it was written"));
  EXPECT_THAT(merged.damaged[1], HasSubstr("000005.json: is cut off"));
  EXPECT_THAT(merged.damaged[2], HasSubstr("000006.json: is cut off"));
  EXPECT_THAT(merged.damaged[3], HasSubstr("000007.json: is of another run"));
  EXPECT_EQ(run(in, 1, 1).made, 4U);
  EXPECT_THAT(remarks_,
              HasSubstr("000004.json: is not as it was written: its sum differs; the run is made again"));
  EXPECT_EQ(merge(in, kRuns, false).digest, digest);
}

TEST_F(Runner, RecordsOfAnotherCampaignAreNotMerged) {
  (void)run(prepared("in", "one"), 1, 1);
  const Merged merged = merge(prepared("in", "two"), kRuns, false);
  EXPECT_EQ(merged.missing.size(), kRuns);
  EXPECT_THAT(merged.damaged.at(0), HasSubstr("is of another campaign"));
}

TEST_F(Runner, WhatTheBenchRefusesIsAResult) {
  const Prepared in = prepared("in");
  (void)run(in, 1, 1,
            "[ $run != 000003 ] || { echo \"/a/b/000003.yaml:7: belt: 80 mm/s is too high\" >&2; exit 65; }");
  const Merged merged = merge(in, kRuns, false);
  EXPECT_EQ(merged.records.at(3).outcome, kRefused);
  EXPECT_EQ(merged.records.at(3).reason, "000003.yaml:7: belt: 80 mm/s is too high");
  EXPECT_EQ(merged.records.at(2).outcome, "PASS");
}

TEST_F(Runner, ABreakIsTriedAgainAndRecordedOnlyIfItIsTheSameTwice) {
  const Prepared in = prepared("in");
  const std::string mark = (folder_.path() / "was-here").string();
  const ShardEnd end = run(in, 1, 1,
                           "case $run in\n"
                           "000001) echo 'the model diverged at 0.1 s' >&2; exit 2;;\n"  // Always.
                           "000002) [ -e '" +
                               mark + "2' ] || { touch '" + mark +
                               "2'; exit 2; };;\n"                 // Once.
                               "000003) kill -9 $$;;\n"            // A crash.
                               "000004) date +%N >&2; exit 2;;\n"  // Never the same words.
                               "000005) exit 0;;\n"                // Says PASS and leaves nothing.
                               "esac");
  EXPECT_EQ(end.broken.size(), 3U);
  EXPECT_THAT(end.broken.at(0), HasSubstr("run 3 was ended by signal 9"));
  EXPECT_THAT(end.broken.at(1), HasSubstr("run 4 ended with exit code 2"));
  EXPECT_THAT(end.broken.at(2), HasSubstr("run 5 left no verdict"));
  const Merged merged = merge(in, kRuns, true);
  EXPECT_EQ(merged.missing, (std::vector<std::size_t>{3, 4, 5}));
  EXPECT_EQ(merged.records.at(1).outcome, kBroken);
  EXPECT_EQ(merged.records.at(1).reason, "the model diverged at 0.1 s");
  EXPECT_EQ(merged.records.at(2).outcome, "PASS");
  EXPECT_EQ(run(in, 1, 1).made, 3U);
}

TEST_F(Runner, AScenarioThatWasChangedMeanwhileIsWrittenAnew) {
  const Prepared in = prepared("in");
  (void)run(in, 1, 1);
  const std::string scenario = base::contentOf(in.scenarioOf(3));
  EXPECT_THAT(scenario, HasSubstr("extends: "));
  (void)folder_.write("in/scenarios/000003.yaml", scenario + "seed: 5\n");
  fs::remove(in.records().fileOf(3));
  EXPECT_EQ(run(in, 1, 1).made, 1U);
  EXPECT_EQ(base::contentOf(in.scenarioOf(3)), scenario);
}

TEST_F(Runner, ResultsStayIfTheyAreWanted) {
  const Prepared in = prepared("in");
  ShardOptions options{.keep = Keep::kBad, .program = bench()};
  (void)runShard(campaign_, in, options);
  EXPECT_FALSE(fs::exists(in.folder / "kept"));
  EXPECT_THAT(fs::is_empty(in.folder / "runs"), true);
  const Prepared all = prepared("all");
  options.keep = Keep::kAll;
  (void)runShard(campaign_, all, options);
  EXPECT_TRUE(fs::exists(all.folder / "kept" / "000008" / "verdict.json"));
}

TEST(CampaignReason, FilesLoseTheirFoldersAndNothingElseDoes) {
  EXPECT_EQ(reasonIn("\n/a/b.yaml:3: x: '../c/d.yaml' (see ./e.txt) 3 mm/s and/or\nmore"),
            "b.yaml:3: x: 'd.yaml' (see e.txt) 3 mm/s and/or");
  EXPECT_EQ(reasonIn(""), "it said nothing");
}

}  // namespace
}  // namespace kerfbench::campaign
