// SPDX-License-Identifier: Apache-2.0
// Runs as child processes: what is told of them, how they are stopped, and what becomes of their clients.
#include "hil/serve/runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <string>

#include "hil/serve/refusal.h"
#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

using Json = nlohmann::json;

class RunsTest : public testing::Test {
 protected:
  RunsTest() { bench_.write("work/a.yaml", "name: a\n"); }

  [[nodiscard]] std::string start(const Json& more = {}) const {
    Json wish{{"scenario", "a.yaml"}, {"trace", false}};
    if (more.is_object()) wish.update(more);
    return Json::parse(client_.post("/api/runs", wish.dump()).body).value("id", "");
  }
  [[nodiscard]] Json of(const std::string& id) const {
    return Json::parse(client_.get("/api/runs/" + id).body);
  }
  /// All events, to the end of the run.
  [[nodiscard]] std::string events(const std::string& id) const {
    return client_.get("/api/runs/" + id + "/events").body;
  }
  /// Follows the events until this was told.
  void waitFor(const std::string& id, const std::string& text) const {
    RawClient raw(client_.port());
    ASSERT_TRUE(raw.send(client_.text({"GET", "/api/runs/" + id + "/events", "", {}})));
    raw.readUntil(text);
  }

  InstalledBench bench_;
  Served served_{bench_};
  Client client_{served_.client()};
};

TEST_F(RunsTest, AreToldFromTheFirstWordToTheLast) {
  bench_.program(R"(
    echo reading; echo trouble >&2
    echo '{"event":"scenario","name":"a","title":"A"}' >> $events
    echo '{"event":"progress","now_s":1,"share":0.5,"what":"running"}' >> $events
    mkdir -p results/a/20261128T160512Z-1a2b3c4d
    echo '{"event":"verdict","verdict":"FAIL","exit_code":1}' >> $events
    echo "{\"event\":\"results\",\"folder\":\"$PWD/results/a/20261128T160512Z-1a2b3c4d\"}" >> $events
    exit 1)");
  const std::string id = start({{"seed", 7}, {"serial_number", "K 7"}});
  const std::string told = events(id);
  for (const char* part :
       {"event: log\ndata: {\"line\":\"reading\"}", "event: log\ndata: {\"line\":\"trouble\"}",
        "event: scenario\n", "event: progress\ndata: {\"left_s\":", "event: verdict\n", "event: end\n"})
    EXPECT_THAT(told, testing::HasSubstr(part));
  const Json run = of(id);
  EXPECT_EQ(run["state"], "ended");
  EXPECT_EQ(run["exit_code"], 1);
  EXPECT_EQ(run["verdict"], "FAIL");
  EXPECT_EQ(run["name"], "a");
  EXPECT_EQ(run["results"], "results/a/20261128T160512Z-1a2b3c4d");
  EXPECT_EQ(run["report"], "/results/a/20261128T160512Z-1a2b3c4d/report.html");
  EXPECT_EQ(run["command"], "kerfbench run a.yaml --seed 7 '--serial-number=K 7'");
  EXPECT_EQ(run["progress"]["share"], 0.5);
}

TEST_F(RunsTest, GetTheFolderAsTheirOwnAndTheWordsAsTheyAre) {
  std::filesystem::create_directories(bench_.path("work/b"));
  bench_.write("work/b/$(touch x);'.yaml", "");
  bench_.write("work/new.hex", "");
  bench_.program("pwd; exit 0");
  const std::string id = start({{"scenario", "b/$(touch x);'.yaml"}, {"image", "new.hex"}});
  EXPECT_THAT(events(id), testing::HasSubstr("{\"line\":\"" + bench_.work().string() + "\"}"));
  EXPECT_EQ(of(id)["command"],
            "kerfbench run 'b/$(touch x);'\\''.yaml' --image " + bench_.path("work/new.hex").string());
  EXPECT_FALSE(std::filesystem::exists(bench_.path("work/x")));
}

TEST_F(RunsTest, WishesThatMeanNothingAreRefused) {
  for (const char* wish : {"{}", R"({"scenario":7})", R"({"scenario":"a.yaml","seed":-1})",
                           R"({"scenario":"a.yaml","seed":"1"})", R"({"scenario":"a.yaml","trace":1})",
                           R"({"scenario":"a.yaml","serial_number":"a\nb"})", R"({"scenario":"../a.yaml"})"})
    EXPECT_THAT(client_.post("/api/runs", wish).status, testing::AnyOf(400, 403)) << wish;
  EXPECT_EQ(client_.post("/api/runs", R"({"scenario":"b.yaml"})").status, 404);
  EXPECT_EQ(client_.get("/api/runs/99").status, 404);
  EXPECT_EQ(client_.get("/api/runs/99/events").status, 404);
  EXPECT_EQ(client_.post("/api/runs/99/stop", "").status, 404);
}

TEST_F(RunsTest, OneAtATimeAndTheOthersWait) {
  bench_.program("echo begun; read line < ../go");
  ASSERT_EQ(::mkfifo(bench_.path("go").c_str(), 0600), 0);
  const std::string first = start(), second = start();
  waitFor(first, "begun");
  EXPECT_EQ(of(first)["state"], "running");
  EXPECT_EQ(of(second)["state"], "waiting");
  for (std::size_t i = 1; i < Runs::kMostWaiting; ++i) (void)start();
  EXPECT_EQ(client_.post("/api/runs", R"({"scenario":"a.yaml"})").status, 409);
  // One that waits is stopped before it begins.
  EXPECT_EQ(client_.post("/api/runs/" + second + "/stop", "").status, 200);
  EXPECT_EQ(of(second)["state"], "stopped");
  bench_.write("go", "on\n");
  EXPECT_THAT(events(first), testing::HasSubstr("event: end"));
  EXPECT_EQ(of(first)["state"], "ended");
}

TEST_F(RunsTest, AreStoppedBySigintAndMayEndAsTheyLike) {
  bench_.program("trap 'echo ending; exit 3' INT; echo begun; while :; do sleep 0.01; done");
  const std::string id = start();
  waitFor(id, "begun");
  EXPECT_EQ(client_.post("/api/runs/" + id + "/stop", "").status, 200);
  EXPECT_THAT(events(id), testing::HasSubstr("ending"));
  EXPECT_EQ(of(id)["state"], "stopped");
  EXPECT_EQ(of(id)["exit_code"], 3);
}

TEST_F(RunsTest, ThatDieAreToldSo) {
  bench_.program("kill -9 $$");
  const std::string id = start();
  EXPECT_THAT(events(id), testing::HasSubstr("event: end"));
  EXPECT_EQ(of(id)["state"], "ended");
  EXPECT_THAT(of(id)["problem"].get<std::string>(), testing::HasSubstr("signal 9"));
  std::filesystem::remove(bench_.path("lib/kerfbench/bin/kerfbench"));
  const std::string missing = start();
  EXPECT_THAT(events(missing), testing::HasSubstr("could not be started"));
}

TEST_F(RunsTest, BrokenEventsArePassedOver) {
  bench_.program(R"(
    printf 'nonsense\n{"event":7}\n[]\n{"event":"progress","what":"\377"}\n{"event":"log' >> $events
    exit 0)");
  const std::string id = start();
  EXPECT_THAT(events(id), testing::HasSubstr("event: end"));
  EXPECT_EQ(of(id)["exit_code"], 0);
}

// A run that is killed while it writes: what there is of its trace comes, and then the answer ends.
TEST_F(RunsTest, ATraceIsFollowedUntilItsRunDies) {
  bench_.program(R"(
    mkdir -p results/a; trace=$PWD/results/a/running.mcap.part
    printf 'one ' > $trace
    echo "{\"event\":\"trace\",\"file\":\"$trace\"}" >> $events
    read line < ../go
    printf 'two' >> $trace
    rm $trace
    kill -9 $$)");
  ASSERT_EQ(::mkfifo(bench_.path("go").c_str(), 0600), 0);
  const std::string id = start({{"trace", true}});
  RawClient raw(client_.port());
  ASSERT_TRUE(raw.send(client_.text({"GET", "/api/runs/" + id + "/trace", "", {}})));
  raw.readUntil("one ");
  bench_.write("go", "on\n");
  bool is_whole = false;
  const std::string all = raw.readToTheEnd();
  EXPECT_EQ(unchunked(all.substr(all.find("\r\n\r\n") + 4), &is_whole), "one two");
  EXPECT_TRUE(is_whole);
  EXPECT_EQ(client_.get("/api/runs/" + id + "/trace?from=4").body, "two") << "afterwards as well";
}

TEST_F(RunsTest, WithoutATraceThereIsNone) {
  const std::string id = start();
  EXPECT_EQ(client_.get("/api/runs/" + id + "/trace").status, 404);
}

// A stream that nobody reads any more gives its place to another.
TEST_F(RunsTest, ClientsThatGoAwayAreNoticed) {
  bench_.program("echo begun; read line < ../go");
  ASSERT_EQ(::mkfifo(bench_.path("go").c_str(), 0600), 0);
  const std::string id = start();
  waitFor(id, "begun");
  for (int round = 0; round < 3; ++round) {
    std::vector<std::unique_ptr<RawClient>> followers;
    for (int i = 0; i < kMostStreams; ++i) {
      followers.push_back(std::make_unique<RawClient>(client_.port()));
      ASSERT_TRUE(followers.back()->send(client_.text({"GET", "/api/runs/" + id + "/events", "", {}})));
      // Clients of the round before may take a moment to be noticed.
      while (replyIn(followers.back()->readUntil("begun")).status == 503) {
        followers.back() = std::make_unique<RawClient>(client_.port());
        ASSERT_TRUE(followers.back()->send(client_.text({"GET", "/api/runs/" + id + "/events", "", {}})));
      }
    }
    EXPECT_EQ(client_.get("/api/runs/" + id + "/events").status, 503);
    EXPECT_EQ(client_.get("/api/session").status, 200) << "others are answered meanwhile";
  }
  bench_.write("go", "on\n");
}

TEST(ShellLine, IsReadByAShellAsItWas) {
  EXPECT_EQ(shellLine({"run", "a.yaml"}), "run a.yaml");
  EXPECT_EQ(shellLine({"", "a b", "it's", "$x"}), R"('' 'a b' 'it'\''s' '$x')");
}

}  // namespace
}  // namespace kerfbench::serve
