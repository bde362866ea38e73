// SPDX-License-Identifier: Apache-2.0
// Rooms of the project: CMake links what the sources include, no links form a circle, the picture in
// ARCHITECTURE.md is this one, and only few rooms may hold the model.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/structure/source_text.h"

namespace {

namespace fs = std::filesystem;
using kerfbench::test::sourceRoot;
using kerfbench::test::textOf;

using Graph = std::map<std::string, std::set<std::string>>;

/// Lines "room: room room".
Graph graphFrom(const std::string& text) {
  Graph graph;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string room;
    if (!(words >> room) || room.back() != ':') continue;
    room.pop_back();
    auto& links = graph[room];
    for (std::string link; words >> link;) links.insert(link);
  }
  return graph;
}

Graph linked() { return graphFrom(textOf(fs::path(KERFBENCH_BINARY_DIR) / "rooms.txt")); }

/// Graph by the includes of the files that lie in the room's own folder.
Graph included(const Graph& rooms) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)/[^"/]+")re");
  Graph graph;
  for (const auto& [room, links] : rooms) {
    auto& found = graph[room];
    for (const auto& entry : fs::directory_iterator(sourceRoot() / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      std::ifstream file(entry.path());
      std::smatch match;
      for (std::string line; std::getline(file, line);) {
        if (!std::regex_search(line, match, kInclude)) continue;
        if (match[1] != room && rooms.contains(match[1])) found.insert(match[1]);
      }
    }
  }
  return graph;
}

/// The rooms that can be reached from `room` by its links, itself only by a circle.
std::set<std::string> reachable(const Graph& graph, const std::string& room) {
  std::set<std::string> seen;
  std::vector<std::string> open{room};
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    for (const std::string& link : graph.at(next)) {
      if (seen.insert(link).second) open.push_back(link);
    }
  }
  return seen;
}

std::string words(const std::set<std::string>& rooms) {
  std::string text;
  for (const std::string& room : rooms) text += room + " ";
  return text;
}

TEST(Rooms, AreLinkedAsTheyInclude) {
  const Graph links = linked();
  const Graph includes = included(links);
  ASSERT_GT(links.size(), 50U);
  for (const auto& [room, rooms] : links) EXPECT_EQ(words(rooms), words(includes.at(room))) << room;
}

TEST(Rooms, HaveNoCircle) {
  const Graph graph = linked();
  for (const auto& [room, links] : graph)
    EXPECT_FALSE(reachable(graph, room).contains(room)) << room << " needs itself";
}

TEST(Rooms, AreAllTheFoldersWithSources) {
  // The children are programs of their own, with a library for them, and the firmware is C without the
  // project's rooms.
  static const std::regex kOther(
      R"(hil/source/(emulator|avr_child|cortex_m_child|mcs51_child)|hil/source/analyser/sigrok_child|firmware_under_test/controller.*|firmware_under_test/planner/kerfplan)");
  const Graph graph = linked();
  for (const char* top : {"twin", "hil", "firmware_under_test"}) {
    for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / top)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string folder = fs::relative(entry.path().parent_path(), sourceRoot()).string();
      if (std::regex_match(folder, kOther)) continue;
      EXPECT_TRUE(graph.contains(folder)) << folder;
    }
  }
}

TEST(Rooms, ThatMeasureAndJudgeReachNothingOfTheTwinButItsBase) {
  const Graph graph = linked();
  for (const auto& [room, links] : graph) {
    const bool judges = room.starts_with("hil/vision") || room.starts_with("hil/inspect") ||
                        room.starts_with("hil/calibrate") || room == "hil/camera" || room == "hil/dieline" ||
                        room == "hil/evidence" || room == "hil/fold/judge";
    if (!judges) continue;
    for (const std::string& reached : reachable(graph, room))
      EXPECT_TRUE(!reached.starts_with("twin/") || reached == "twin/base") << room << " reaches " << reached;
  }
}

/// What a file includes in quotes; each is read once.
const std::vector<std::string>& directIncludes(const std::string& path) {
  static const std::regex kInclude(R"re(#include "([^"]+)")re");
  static std::map<std::string, std::vector<std::string>> known;
  const auto [place, is_new] = known.try_emplace(path);
  if (is_new && fs::exists(sourceRoot() / path)) {
    const std::string text = textOf(sourceRoot() / path);
    for (std::sregex_iterator it(text.begin(), text.end(), kInclude), end; it != end; ++it)
      place->second.push_back((*it)[1].str());
  }
  return place->second;
}

/// Project headers that a file includes, directly or through others.
std::set<std::string> includedBy(const std::string& path) {
  std::set<std::string> seen;
  std::vector<std::string> open{path};
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    for (const std::string& header : directIncludes(next)) {
      if (seen.insert(header).second) open.push_back(header);
    }
  }
  return seen;
}

TEST(Rooms, ThatHoldATwinIsTheRunAlone) {
  int holders = 0;
  for (const auto& entry : fs::recursive_directory_iterator(sourceRoot() / "hil")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
    const std::string path = fs::relative(entry.path(), sourceRoot()).string();
    const bool holds = includedBy(path).contains("twin/cutter/twin.h");
    if (holds) ++holders;
    EXPECT_FALSE(holds && !path.starts_with("hil/run/")) << path << " reaches twin/cutter/twin.h";
  }
  EXPECT_GT(holders, 2);
}

TEST(Rooms, ArePicturedInArchitectureAsTheyAre) {
  const std::string text = textOf(sourceRoot() / "ARCHITECTURE.md");
  const std::string begin = "```rooms\n";
  const auto from = text.find(begin);
  ASSERT_NE(from, std::string::npos) << "ARCHITECTURE.md has no block ```rooms";
  const std::string block =
      text.substr(from + begin.size(), text.find("```", from + begin.size()) - from - begin.size());
  EXPECT_EQ(graphFrom(block), linked()) << "put the lines of " << KERFBENCH_BINARY_DIR << "/rooms.txt there";
}

}  // namespace
