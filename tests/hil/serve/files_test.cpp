// SPDX-License-Identifier: Apache-2.0
// What a client can see and write of files, over the wire.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

using Json = nlohmann::json;

class FilesTest : public testing::Test {
 protected:
  [[nodiscard]] Json list() const { return Json::parse(client_.get("/api/files").body); }
  static std::vector<std::string> pathsIn(const Json& rows) {
    std::vector<std::string> paths;
    for (const Json& row : rows) paths.push_back(row["path"]);
    return paths;
  }
  InstalledBench bench_;
  Served served_{bench_};
  Client client_{served_.client()};
};

TEST_F(FilesTest, AreListedByWhatTheyAre) {
  std::filesystem::create_directories(bench_.path("work/jobs"));
  bench_.write("work/jobs/a.yaml",
               "name: a\ntitle: First\nmachine: m.yaml\ndieline: d.dxf\nfirmware: {source: native}\n");
  bench_.write("work/m.yaml", "name: mine\nkind: gantry\npins: {a: PA0}\n");
  bench_.write("work/broken.yaml", "name: [\n");
  bench_.write("work/other.yaml", "runs: []\n");
  bench_.write("work/d.dxf", "");
  bench_.write("work/new.hex", "");
  bench_.write("work/a.mcap", "12345");
  bench_.write("work/.hidden.yaml", "name: hidden\nmachine: m.yaml\ndieline: d.dxf\n");
  const Json files = list();
  EXPECT_THAT(pathsIn(files["scenarios"]),
              testing::ElementsAre("broken.yaml", "jobs/a.yaml", "shipped/scenarios/label.yaml"));
  EXPECT_EQ(files["scenarios"][1]["title"], "First");
  EXPECT_TRUE(files["scenarios"][0].contains("problem"));
  EXPECT_THAT(pathsIn(files["machines"]), testing::ElementsAre("m.yaml"));
  EXPECT_THAT(pathsIn(files["drawings"]), testing::ElementsAre("d.dxf"));
  EXPECT_THAT(pathsIn(files["images"]), testing::ElementsAre("new.hex"));
  EXPECT_EQ(files["traces"], Json::parse(R"([{"path":"a.mcap","bytes":5}])"));
}

TEST_F(FilesTest, CalibrationsByHandAreListedAndTold) {
  for (const char* folder : {"head", "results/head"})
    std::filesystem::create_directories(bench_.work() / folder);
  bench_.write("work/head/steps.json", R"({"version":1})");
  bench_.write("work/results/head/steps.json", "{}");
  const std::filesystem::path older = bench_.path("work/results/head/steps.json");
  std::filesystem::last_write_time(older, std::filesystem::last_write_time(older) - std::chrono::hours(1));
  EXPECT_THAT(pathsIn(list()["service"]), testing::ElementsAre("head", "results/head"));
  EXPECT_EQ(client_.get("/api/service?path=head").body, R"({"version":1})");
  EXPECT_EQ(client_.get("/api/service?path=none").status, 404);
  EXPECT_EQ(client_.get("/api/service?path=..%2Fwork%2Fhead").status, 400);
}

TEST_F(FilesTest, WhatACalibrationIsMadeOfIsListedByItsKind) {
  for (const char* folder : {"head/1-grid/pictures", "results/head/1-grid/pictures",
                             "results/label/20261128T160512Z-1a2b3c4d", "results/label/spot"})
    std::filesystem::create_directories(bench_.work() / folder);
  bench_.write("work/head/1-grid/pictures/tiles.yaml", "version: 1\ntiles: []\n");
  bench_.write("work/head/1-grid/pictures/scan.yaml", "version: 1\nlid: black\n");
  bench_.write("work/head/1-grid/pictures/scan.png", "");
  bench_.write("work/head/1-grid/pictures/tile-0001.jpg", "");
  bench_.write("work/results/head/1-grid/pictures/tile-0000.png", "");
  bench_.write("work/results/head/correction.csv", "");
  bench_.write("work/glass.yaml", "scanner_id: glass-1\ndate: 2026-11-21\n");
  bench_.write("work/kerf.camera.yaml", "camera_id: kerf-1\ndate: 2026-11-20\n");
  bench_.write("work/target.yaml", "square_mm: 5.4\n");
  bench_.write("work/broken.yaml", "scanner_id: [\n");
  bench_.write("work/results/label/20261128T160512Z-1a2b3c4d/board.png", "");
  const Json files = list()["service_files"];
  const auto row = [](const char* path, const char* kind) { return Json{{"path", path}, {"kind", kind}}; };
  Json scanner = row("glass.yaml", "scanner"), camera = row("kerf.camera.yaml", "camera");
  scanner.update({{"id", "glass-1"}, {"date", "2026-11-21"}});
  camera.update({{"id", "kerf-1"}, {"date", "2026-11-20"}});
  EXPECT_THAT(
      files, testing::ElementsAre(scanner, row("head/1-grid/pictures/scan.png", "scan"),
                                  row("head/1-grid/pictures/scan.yaml", "scan-list"),
                                  row("head/1-grid/pictures/tile-0001.jpg", "photograph"),
                                  row("head/1-grid/pictures/tiles.yaml", "tiles"), camera,
                                  row("results/head/1-grid/pictures/tile-0000.png", "photograph"),
                                  row("results/head/correction.csv", "table"), row("target.yaml", "target")));
}

TEST_F(FilesTest, RunsAreListedTheNewestFirst) {
  for (const char* run : {"label/20261128T160512Z-1a2b3c4d", "other/20261129T160512Z-1a2b3c4d"})
    std::filesystem::create_directories(bench_.path("work/results") / run);
  bench_.write("work/results/label/20261128T160512Z-1a2b3c4d/verdict.json",
               R"({"scenario":"label","verdict":"PASS","serial_number":"K-7"})");
  std::filesystem::create_directory_symlink("20261128T160512Z-1a2b3c4d",
                                            bench_.path("work/results/label/latest"));
  const Json runs = list()["runs"];
  EXPECT_THAT(pathsIn(runs), testing::ElementsAre("results/other/20261129T160512Z-1a2b3c4d",
                                                  "results/label/20261128T160512Z-1a2b3c4d"));
  EXPECT_EQ(runs[0]["verdict"], nullptr);
  EXPECT_EQ(runs[1]["verdict"], "PASS");
  EXPECT_EQ(runs[1]["serial_number"], "K-7");
  EXPECT_EQ(runs[1]["when"], "2026-11-28T16:05:12Z");
  EXPECT_EQ(list()["runs"], runs) << "the second time they are remembered";
}

TEST_F(FilesTest, AreWrittenAndReadByteForByte) {
  std::string all;
  for (int i = 0; i < 100'000; ++i) all += static_cast<char>(i % 251);
  EXPECT_EQ(client_.put("/api/files?path=jobs%2FMy%20drawing.dxf", all).status, 200);
  EXPECT_EQ(client_.get("/api/files/content?path=jobs/My+drawing.dxf").body, all);
  const Reply part =
      client_.ask({"GET", "/api/files/content?path=jobs/My+drawing.dxf", "", {{"Range", "bytes=99990-"}}});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, all.substr(99'990));
  EXPECT_EQ(part.header("content-range"), "bytes 99990-99999/100000");
}

TEST_F(FilesTest, NamesThatLeadOutAreRefusedInAllSpellings) {
  bench_.write("secret.yaml", "secret");
  for (const char* name :
       {"../secret.yaml", "%2e%2e/secret.yaml", "..%2fsecret.yaml", "%2e%2e%2fsecret.yaml",
        "..%5csecret.yaml", "a/../../secret.yaml", "%2fetc%2fpasswd", "/etc/passwd", "shipped/../secret.yaml",
        "shipped/%2e%2e/secret.yaml", "....//secret.yaml", "%252e%252e/secret.yaml",
        "%c0%ae%c0%ae/secret.yaml", "secret.yaml%00.dxf", "a%0d%0ab.yaml"}) {
    const std::string path = fmt::format("?path={}", name);
    const Reply read = client_.get("/api/files/content" + path);
    EXPECT_THAT(read.status, testing::AnyOf(400, 403, 404)) << name;
    EXPECT_THAT(read.body, testing::Not(testing::HasSubstr("secret\n"))) << name;
    EXPECT_THAT(client_.put("/api/files" + path, "x").status, testing::AnyOf(400, 403)) << name;
  }
  EXPECT_EQ(base::contentOf(bench_.path("secret.yaml")), "secret");
  for (const char* target : {"/window/../index.html", "/window/%2e%2e/bin/kerfbench", "/window/index.html",
                             "/window/", "/window/a/b.js", "/results/../a"})
    EXPECT_EQ(client_.get(target).status == 200, false) << target;
}

TEST_F(FilesTest, AHostileNameIsTextInEveryAnswer) {
  const std::string name = "<img src=x onerror=alert(1)>.dxf";
  bench_.write("work/" + name, "drawing");
  const Reply reply = client_.get("/api/files");
  EXPECT_EQ(reply.header("content-type"), "application/json");
  EXPECT_THAT(pathsIn(Json::parse(reply.body)["drawings"]), testing::ElementsAre(name));
  const Reply content = client_.get("/api/files/content?path=" + percentEncoded(name));
  EXPECT_EQ(content.body, "drawing");
  EXPECT_THAT(content.header("content-security-policy"), testing::StartsWith("sandbox;"));
  const Reply missing = client_.get("/api/files/content?path=" + percentEncoded("\"<script>.dxf"));
  EXPECT_EQ(missing.status, 404);
  EXPECT_EQ(Json::parse(missing.body)["error"], "There is no file '\"<script>.dxf'.");
}

TEST_F(FilesTest, AScenarioIsSavedWithItsGcode) {
  const Json scenario{{"text", "name: a\nplanner: {gcode: a.gcode}\n"}, {"gcode", "G00 X1\n"}};
  const Reply reply = client_.put("/api/scenario?path=jobs/a.yaml", scenario.dump());
  EXPECT_EQ(Json::parse(reply.body),
            Json::parse(R"({"path":"jobs/a.yaml","command":"kerfbench run jobs/a.yaml"})"));
  EXPECT_EQ(base::contentOf(bench_.path("work/jobs/a.yaml")), scenario["text"]);
  EXPECT_EQ(base::contentOf(bench_.path("work/jobs/a.gcode")), "G00 X1\n");
  EXPECT_EQ(client_.put("/api/scenario?path=a.dxf", scenario.dump()).status, 415);
  EXPECT_EQ(client_.put("/api/scenario?path=shipped/scenarios/label.yaml", scenario.dump()).status, 403);
  EXPECT_EQ(client_.put("/api/scenario?path=a.yaml", R"({"text":1})").status, 400);
}

TEST_F(FilesTest, ATraceIsReadInParts) {
  bench_.write("work/a.mcap", "0123456789");
  bench_.write("work/a.yaml", "secret");
  EXPECT_EQ(client_.ask({"GET", "/api/trace?path=a.mcap", "", {{"Range", "bytes=2-4"}}}).body, "234");
  EXPECT_EQ(client_.get("/api/trace?path=a.yaml").status, 415);
  EXPECT_EQ(client_.get("/api/trace").status, 400);
}

}  // namespace
}  // namespace kerfbench::serve
