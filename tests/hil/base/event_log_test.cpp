// SPDX-License-Identifier: Apache-2.0
#include "hil/base/event_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "hil/base/console.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::base {
namespace {

TEST(EventLog, WritesALineOfJsonForEachEvent) {
  const TempFolder folder;
  EventLog log(folder.path() / "events");
  log.tell("pins", {{"now_s", 0.5},
                    {"edges", std::vector<std::int64_t>{1, 2}},
                    {"signals", std::vector<std::string>{"a", "b"}},
                    {"lost", false},
                    {"count", std::int64_t{7}}});
  log.tell("said", {{"text", std::string("line\n\"quoted\" \xff")}, {"share", std::nan("")}});
  EXPECT_EQ(contentOf(folder.path() / "events"),
            "{\"event\":\"pins\",\"now_s\":0.5,\"edges\":[1,2],\"signals\":[\"a\",\"b\"],\"lost\":false,"
            "\"count\":7}\n"
            "{\"event\":\"said\",\"text\":\"line\\n\\\"quoted\\\" �\",\"share\":null}\n");
}

TEST(EventLog, AppendsAndKeepsLinesOfSeveralThreadsWhole) {
  const TempFolder folder;
  const auto path = folder.write("events", "before\n");
  {
    EventLog log(path);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&log] {
        for (int i = 0; i < 200; ++i) log.tell("x", {{"text", std::string(1000, 'a')}});
      });
  }
  const std::string text = contentOf(path);
  const std::string line = "{\"event\":\"x\",\"text\":\"" + std::string(1000, 'a') + "\"}\n";
  EXPECT_EQ(text.size(), 7 + 800 * line.size());
  for (std::size_t at = 7; at < text.size(); at += line.size())
    ASSERT_EQ(text.compare(at, line.size(), line), 0);
}

TEST(EventLog, AFolderThatIsNotThereIsTold) {
  const TempFolder folder;
  EXPECT_THROW(EventLog(folder.path() / "none" / "events"), std::system_error);
}

TEST(Console, TellsTheShareThatIsDoneAlsoWhenQuiet) {
  const TempFolder folder;
  const auto path = folder.path() / "events";
  {
    Console console(true, path);
    console.progress(1.0, "running");
    console.expect(4.0);
    console.progress(2.0, "judging");
    console.progress(9.0, "waiting");
    console.progress(-1.0, "looking at the cut");
  }
  EXPECT_EQ(contentOf(path),
            "{\"event\":\"progress\",\"now_s\":1.0,\"what\":\"running\"}\n"
            "{\"event\":\"progress\",\"now_s\":2.0,\"share\":0.5,\"what\":\"judging\"}\n"
            "{\"event\":\"progress\",\"now_s\":9.0,\"share\":1.0,\"what\":\"waiting\"}\n"
            "{\"event\":\"progress\",\"what\":\"looking at the cut\"}\n");
}

// The next word comes at its time, and not with each quantum.
TEST(Console, TellsNoMoreThanAnybodyCanRead) {
  const TempFolder folder;
  const auto path = folder.path() / "events";
  {
    Console console(true, path);
    for (int i = 0; i < 20'000; ++i) console.progress(i, "running, " + std::to_string(i) + " sent");
  }
  const std::string text = contentOf(path);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 2000);
  EXPECT_GE(std::count(text.begin(), text.end(), '\n'), 1);
}

}  // namespace
}  // namespace kerfbench::base
