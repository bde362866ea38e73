// SPDX-License-Identifier: Apache-2.0
// Many clients, slow clients, and those that send too much.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "hil/base/input_error.h"
#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

/// Bytes of memory that this process has.
std::size_t residentBytes() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(Clients, AHundredAtOnceAreAllAnswered) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 100; ++i) clients.push_back(std::make_unique<RawClient>(served.port()));
  for (const auto& each : clients) ASSERT_TRUE(each->send(client.text({"GET", kSessionPath, "", {}})));
  for (const auto& each : clients) EXPECT_EQ(replyIn(each->readToTheEnd()).status, 200);
}

TEST(Clients, AHundredStrangersAreAnsweredOrTurnedAway) {
  const InstalledBench bench;
  const Served served(bench);
  const Client known = served.client();
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 100; ++i) clients.push_back(std::make_unique<RawClient>(served.port()));
  for (const auto& each : clients)
    ASSERT_TRUE(each->send(served.stranger().text({"GET", "/window/main.js", "", {}})));
  EXPECT_EQ(known.get(kSessionPath).status, 200);
  for (const auto& each : clients)
    EXPECT_THAT(replyIn(each->readToTheEnd()).status, testing::AnyOf(200, 503));
}

TEST(Clients, OneConnectionAsksAgainAndAgain) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  RawClient raw(served.port());
  const std::string question = client.text({"GET", "/window/main.js", "", {{"Connection", "keep-alive"}}});
  const std::string put =
      client.text({"PUT", "/api/files?path=a.yaml", "abc", {{"Connection", "keep-alive"}}});
  for (int i = 0; i < 50; ++i) {
    // Two in one go, one of which has a body.
    ASSERT_TRUE(raw.send(put + question));
    while (std::ranges::count(raw.hasRead(), '}') < 2 * (i + 1)) ASSERT_TRUE(raw.readSome());
  }
  EXPECT_EQ(base::contentOf(bench.path("work/a.yaml")), "abc");
}

// Each sends a byte now and then, and never a whole head: none of them costs a thread.
TEST(Clients, SlowOnesKeepNobodyWaiting) {
  const InstalledBench bench;
  DoorLimits limits;
  limits.most_at_work = 2;
  const Served served(bench, limits);
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 200; ++i) {
    slow.push_back(std::make_unique<RawClient>(served.port()));
    ASSERT_TRUE(slow.back()->send("GET / HTTP/1.1\r\nHost: 127"));
  }
  const Client client = served.client();
  for (int i = 0; i < 5; ++i) {
    for (const auto& each : slow) ASSERT_TRUE(each->send("."));
    EXPECT_EQ(client.get(kSessionPath).status, 200);
  }
}

TEST(Clients, WhoDoesNotEndHisHeadIsLetGo) {
  const InstalledBench bench;
  DoorLimits limits;
  limits.head = std::chrono::milliseconds(50);
  const Served served(bench, limits);
  RawClient begun(served.port()), silent(served.port());
  ASSERT_TRUE(begun.send("GET / HTTP/1.1\r\n"));
  EXPECT_EQ(begun.readToTheEnd(), "");
  EXPECT_EQ(silent.readToTheEnd(), "");
}

TEST(Clients, OfTooManyTheOldestIsLetGo) {
  const InstalledBench bench;
  DoorLimits limits;
  limits.most_connections = 8;
  const Served served(bench, limits);
  std::vector<std::unique_ptr<RawClient>> waiting;
  for (int i = 0; i < 9; ++i) {
    waiting.push_back(std::make_unique<RawClient>(served.port()));
    ASSERT_TRUE(waiting.back()->send("GET"));
  }
  EXPECT_EQ(waiting.front()->readToTheEnd(), "");
  ASSERT_TRUE(waiting.back()->send(
      " / HTTP/1.1\r\nConnection: close\r\nHost: 127.0.0.1:" + std::to_string(served.port()) + "\r\n\r\n"));
  EXPECT_EQ(replyIn(waiting.back()->readToTheEnd()).status, 200);
}

// cpp-httplib 0.11.4 by itself would take it all in before it looks (CVE-2025-53628).
TEST(Clients, AHeadWithoutEndIsRefusedEarly) {
  const InstalledBench bench;
  const Served served(bench);
  const std::size_t before = residentBytes();
  for (int i = 0; i < 20; ++i) {
    RawClient raw(served.port());
    const std::string line(1 << 20, 'a');
    bool is_open = raw.send("GET /");
    for (int k = 0; k < 16 && is_open; ++k) is_open = raw.send(line);
    EXPECT_TRUE(!is_open || replyIn(raw.readToTheEnd()).status == 431);
  }
  EXPECT_LT(residentBytes(), before + (std::size_t{64} << 20U)) << "of 320 MB that were sent";
}

TEST(Clients, AnUploadOfAGigabyteIsRefusedBeforeItComes) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  const std::size_t before = residentBytes();
  RawClient raw(served.port());
  const std::string gigabyte = std::to_string(std::uint64_t{1} << 30U);
  ASSERT_TRUE(raw.send(client.text({"PUT", "/api/files?path=big.dxf", "", {{"Content-Length", gigabyte}}})));
  const Reply reply = replyIn(raw.readUntil("}\n"));
  EXPECT_EQ(reply.status, 413);
  EXPECT_THAT(reply.body, testing::HasSubstr("at most 64 MiB"));
  // Who sends on all the same is cut off.
  const std::string megabyte(1 << 20, 'x');
  bool is_open = true;
  for (int i = 0; i < 1024 && is_open; ++i) is_open = raw.send(megabyte);
  EXPECT_LT(residentBytes(), before + (std::size_t{64} << 20U));
  EXPECT_FALSE(std::filesystem::exists(bench.path("work/big.dxf")));
  EXPECT_EQ(client.get(kSessionPath).status, 200);
}

TEST(Clients, AStrangersUploadIsRefusedBeforeItComes) {
  const InstalledBench bench;
  const Served served(bench);
  RawClient raw(served.port());
  ASSERT_TRUE(
      raw.send(served.stranger().text({"PUT", "/api/files?path=a.dxf", "", {{"Content-Length", "1000"}}})));
  EXPECT_EQ(replyIn(raw.readUntil("}\n")).status, 401);
}

TEST(Clients, BodiesInChunksAreRefused) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  RawClient raw(served.port());
  ASSERT_TRUE(raw.send(
      client.text({"POST", "/api/runs", "", {{"Content-Length", ""}, {"Transfer-Encoding", "chunked"}}}) +
      "-2\r\naaaaaaaa"));
  EXPECT_EQ(replyIn(raw.readUntil("}\n")).status, 501);
}

// The largest file that is taken goes to the disk, not into the memory.
TEST(Clients, AnUploadOf64MiBNeedsNoMemory) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  const std::size_t before = residentBytes();
  RawClient raw(served.port());
  ASSERT_TRUE(raw.send(client.text(
      {"PUT", "/api/files?path=big.dxf", "", {{"Content-Length", std::to_string(kMostFileBytes)}}})));
  const std::string megabyte(1 << 20, 'x');
  for (int i = 0; i < 64; ++i) ASSERT_TRUE(raw.send(megabyte));
  EXPECT_EQ(replyIn(raw.readToTheEnd()).status, 200);
  EXPECT_EQ(std::filesystem::file_size(bench.path("work/big.dxf")), kMostFileBytes);
  EXPECT_LT(residentBytes(), before + (std::size_t{32} << 20U));
}

TEST(Clients, AnUploadThatStopsLeavesNothing) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  bench.write("work/a.dxf", "as it was");
  {
    RawClient raw(served.port());
    ASSERT_TRUE(
        raw.send(client.text({"PUT", "/api/files?path=a.dxf", "half", {{"Content-Length", "1000"}}})));
  }
  // The next request on the same file comes after it, or beside it.
  EXPECT_EQ(client.get("/api/files/content?path=a.dxf").body, "as it was");
  EXPECT_EQ(client.put("/api/files?path=a.dxf", "new").status, 200);
  EXPECT_EQ(client.get("/api/files/content?path=a.dxf").body, "new");
}

TEST(Clients, DeepJsonIsRefused) {
  const InstalledBench bench;
  const Served served(bench);
  const Client client = served.client();
  EXPECT_EQ(client.post("/api/runs", std::string(1 << 20, '[')).status, 400);
  EXPECT_EQ(client.post("/api/runs", "{\"scenario\":" + std::string(100'000, '{')).status, 400);
  EXPECT_EQ(client.post("/api/runs", "[]").status, 400);
  EXPECT_EQ(client.post("/api/runs", "{\"scenario\":\"\xff\"}").status, 400);
}

/// Local addresses of this process's listening sockets with this port, as the kernel writes them.
std::vector<std::string> listenersAt(int port) {
  std::vector<std::string> found;
  const std::string wanted = fmt::format(":{:04X}", port);
  for (const char* table : {"/proc/self/net/tcp", "/proc/self/net/tcp6"}) {
    std::ifstream lines(table);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string number, local, remote, state;
      words >> number >> local >> remote >> state;
      if (local.ends_with(wanted) && state == "0A") found.push_back(local.substr(0, local.size() - 5));
    }
  }
  return found;
}

TEST(Listening, IsAt127001AloneUnlessTold) {
  const InstalledBench bench;
  const Served served(bench);
  EXPECT_THAT(listenersAt(served.port()), testing::ElementsAre("0100007F"));
  const Served open(bench, {}, "0.0.0.0");
  EXPECT_THAT(listenersAt(open.port()), testing::ElementsAre("00000000"));
  EXPECT_FALSE(RawClient(served.port(), "127.0.0.2").isConnected());
}

TEST(Listening, TwoServersDoNotShareAPort) {
  const InstalledBench bench;
  const Served served(bench);
  EXPECT_THROW(FrontDoor({"127.0.0.1", served.port()}, {}), base::InputError);
  EXPECT_THROW(FrontDoor({"localhost", 0}, {}), base::InputError);
  EXPECT_THROW(FrontDoor({"evil.example", 0}, {}), base::InputError);
}

}  // namespace
}  // namespace kerfbench::serve
