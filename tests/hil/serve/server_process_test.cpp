// SPDX-License-Identifier: Apache-2.0
// The program itself: what it prints, and that its children end with it, however it ends.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/hil/serve/served.h"

namespace kerfbench::serve {
namespace {

/// kerfbench-window of an installed bench, as a child.
class WindowProcess {
 public:
  WindowProcess(const InstalledBench& bench, std::vector<std::string> words) {
    const std::string program = bench.path("lib/kerfbench/bin/kerfbench-window").string();
    std::filesystem::copy_file(KERFBENCH_WINDOW_PROGRAM, program,
                               std::filesystem::copy_options::overwrite_existing);
    words.insert(words.begin(), program);
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    pid_ = ::fork();
    if (pid_ == 0) {
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::dup2(ends[1], STDOUT_FILENO);
      ::dup2(ends[1], STDERR_FILENO);
      if (::chdir(bench.work().c_str()) == 0) ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    output_ = base::UniqueFd(ends[0]);
  }
  ~WindowProcess() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
  }
  WindowProcess(const WindowProcess&) = delete;
  WindowProcess& operator=(const WindowProcess&) = delete;

  /// What it has printed, at least up to this.
  const std::string& printedUntil(const std::string& text) {
    while (printed_.find(text) == std::string::npos && readSome()) {
    }
    return printed_;
  }
  const std::string& printedToTheEnd() {
    while (readSome()) {
    }
    return printed_;
  }
  /// "http://127.0.0.1:PORT" and the token behind it.
  void readLink(int& port, std::string& token) {
    std::smatch link;
    const std::string printed = printedUntil("\n");
    static const std::regex kLink(R"(http://[0-9.]+:(\d+)/[a-z]*\?token=([A-Za-z0-9_-]+))");
    ASSERT_TRUE(std::regex_search(printed, link, kLink)) << printed;
    port = std::stoi(link[1]);
    token = link[2];
  }
  void signal(int number) const { ::kill(pid_, number); }
  int status() {
    int status = 0;
    ::waitpid(std::exchange(pid_, -1), &status, 0);
    return status;
  }

 private:
  bool readSome() {
    pollfd poller{output_.get(), POLLIN, 0};
    if (::poll(&poller, 1, kPatience_ms) <= 0) return false;
    std::array<char, 4096> block{};
    const ssize_t got = ::read(output_.get(), block.data(), block.size());
    if (got > 0) printed_.append(block.data(), static_cast<std::size_t>(got));
    return got > 0;
  }
  pid_t pid_{-1};
  base::UniqueFd output_;
  std::string printed_;
};

class ServerProcessTest : public testing::TestWithParam<int> {
 protected:
  InstalledBench bench_;
};

// The child has the end of a pipe; when that is closed, no process of the run is left.
TEST_P(ServerProcessTest, ItsRunsEndWithIt) {
  bench_.write("work/a.yaml", "name: a\n");
  ASSERT_EQ(::mkfifo(bench_.path("alive").c_str(), 0600), 0);
  bench_.program(
      "trap '' INT; exec 3> ../alive; echo begun; (while :; do sleep 1; done) & while :; do sleep 1; done");
  WindowProcess process(bench_, {"serve"});
  int port = 0;
  std::string token;
  process.readLink(port, token);
  Client client(port);
  client.logIn(token);
  ASSERT_EQ(client.post("/api/runs", R"({"scenario":"a.yaml","trace":false})").status, 200);
  const base::UniqueFd alive(::open(bench_.path("alive").c_str(), O_RDONLY | O_CLOEXEC));
  process.signal(GetParam());
  const int status = process.status();
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  pollfd poller{alive.get(), POLLIN, 0};
  ASSERT_EQ(::poll(&poller, 1, kPatience_ms), 1) << "a process of the run lives on";
  char byte = 0;
  EXPECT_EQ(::read(alive.get(), &byte, 1), 0);
}

INSTANTIATE_TEST_SUITE_P(ByAnySignal, ServerProcessTest, testing::Values(SIGINT, SIGTERM, SIGHUP));

// The kernel does it: there is nobody left who could.
TEST_F(ServerProcessTest, ARunEndsWithAServerThatIsKilled) {
  bench_.write("work/a.yaml", "name: a\n");
  ASSERT_EQ(::mkfifo(bench_.path("alive").c_str(), 0600), 0);
  bench_.program("exec 3> ../alive; while :; do read line < ../never; done");
  ASSERT_EQ(::mkfifo(bench_.path("never").c_str(), 0600), 0);
  WindowProcess process(bench_, {"serve"});
  int port = 0;
  std::string token;
  process.readLink(port, token);
  Client client(port);
  client.logIn(token);
  ASSERT_EQ(client.post("/api/runs", R"({"scenario":"a.yaml","trace":false})").status, 200);
  const base::UniqueFd alive(::open(bench_.path("alive").c_str(), O_RDONLY | O_CLOEXEC));
  process.signal(SIGKILL);
  EXPECT_TRUE(WIFSIGNALED(process.status()));
  pollfd poller{alive.get(), POLLIN, 0};
  ASSERT_EQ(::poll(&poller, 1, kPatience_ms), 1) << "the run lives on";
  char byte = 0;
  EXPECT_EQ(::read(alive.get(), &byte, 1), 0);
}

TEST_F(ServerProcessTest, PrintsALinkForEachBrowser) {
  WindowProcess process(bench_, {"serve"});
  int port = 0;
  std::string token;
  process.readLink(port, token);
  EXPECT_EQ(process.printedUntil("\n"), fmt::format("http://127.0.0.1:{}/?token={}\n", port, token));
  Client client(port);
  EXPECT_EQ(client.logIn(token).status, 303);
  EXPECT_THAT(process.printedUntil("another"), testing::HasSubstr("for another browser: http://127.0.0.1:"));
  process.signal(SIGTERM);
  EXPECT_EQ(process.status(), 0);
}

TEST_F(ServerProcessTest, SaysWhatItMeansWhenOthersReachIt) {
  WindowProcess process(bench_, {"serve", "--address", "0.0.0.0"});
  EXPECT_THAT(process.printedUntil("token="), testing::AllOf(testing::HasSubstr("other computers reach it"),
                                                             testing::HasSubstr("start programs as you")));
  process.signal(SIGTERM);
}

TEST_F(ServerProcessTest, OpensATraceAtItsMoment) {
  bench_.write("work/my run.mcap", "trace");
  bench_.write("elsewhere.mcap", "trace");
  {
    WindowProcess process(bench_, {"view", "my run.mcap", "--at", "1.25"});
    EXPECT_THAT(process.printedUntil("\n"),
                testing::AllOf(testing::HasSubstr("/view?token="),
                               testing::HasSubstr("&trace=my%20run.mcap#t=1.25\n")));
  }
  {
    WindowProcess process(bench_, {"view", "../elsewhere.mcap"});
    int port = 0;
    std::string token;
    process.readLink(port, token);
    Client client(port);
    client.logIn(token);
    EXPECT_EQ(client.get("/api/trace?path=elsewhere.mcap").body, "trace");
    EXPECT_THAT(nlohmann::json::parse(client.get("/api/session").body)["folder"].get<std::string>(),
                testing::Not(testing::EndsWith("work")));
  }
}

TEST_F(ServerProcessTest, RefusesWhatItCannotServe) {
  const auto refused = [this](const std::vector<std::string>& words) {
    WindowProcess process(bench_, words);
    const std::string printed = process.printedToTheEnd();
    const int status = process.status();
    EXPECT_TRUE(WIFEXITED(status));
    return std::pair(WEXITSTATUS(status), printed);
  };
  using testing::HasSubstr;
  using testing::Pair;
  EXPECT_THAT(refused({"view", "none.mcap"}), Pair(65, HasSubstr("none.mcap: no such file")));
  bench_.write("work/a.yaml", "");
  EXPECT_THAT(refused({"view", "a.yaml"}), Pair(65, HasSubstr("the name of a trace ends in .mcap")));
  EXPECT_THAT(refused({"serve", "none"}), Pair(64, HasSubstr("none")));
  EXPECT_THAT(refused({"serve", "--address", "evil.example"}),
              Pair(65, HasSubstr("not an address as a number")));
  EXPECT_THAT(refused({"serve", "--port", "70000"}), Pair(64, HasSubstr("70000")));
  EXPECT_THAT(refused({"serve", "--bench", "http://evil.example/"}),
              Pair(65, HasSubstr("--bench http://evil.example/")));
  std::filesystem::remove(bench_.path("lib/kerfbench/window/index.html"));
  EXPECT_THAT(refused({"serve"}), Pair(65, HasSubstr("./bench serve makes them")));
}

}  // namespace
}  // namespace kerfbench::serve
