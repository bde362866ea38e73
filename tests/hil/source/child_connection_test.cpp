// SPDX-License-Identifier: Apache-2.0
#include "hil/source/child_connection.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <thread>
#include <vector>

#include "hil/base/spawn_setup.h"
#include "hil/base/unique_fd.h"
#include "hil/source/open.h"

namespace kerfbench::source {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kImage = KERFBENCH_IMAGES "/pulses-atmega2560.hex";

/// The emulator behind a port of this computer, as inetd or a container has it: its standard input and output
/// are the connection. Serves one; without a program it hangs up at once.
class Server {
 public:
  explicit Server(std::string program) : program_(std::move(program)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* any = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener_.get(), any, sizeof address), 0);
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
    socklen_t size = sizeof address;
    EXPECT_EQ(::getsockname(listener_.get(), any, &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() { thread_.join(); }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  [[nodiscard]] std::string address() const { return "tcp:127.0.0.1:" + std::to_string(port_); }

 private:
  void serve() const {
    const base::UniqueFd connection(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (program_.empty()) return;
    base::SpawnSetup setup;
    ::posix_spawn_file_actions_adddup2(&setup.actions, connection.get(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&setup.actions, connection.get(), STDOUT_FILENO);
    std::string argument = program_;
    char* const arguments[] = {argument.data(), nullptr};
    char* const environment[] = {nullptr};
    pid_t pid = -1;
    EXPECT_EQ(
        ::posix_spawn(&pid, program_.c_str(), &setup.actions, &setup.attributes, arguments, environment), 0);
    int status = -1;
    EXPECT_EQ(::waitpid(pid, &status, 0), pid);
    EXPECT_EQ(status, 0) << "a child that is hung up on ends by itself";
  }

  std::string program_;
  base::UniqueFd listener_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  std::uint16_t port_{};
  std::thread thread_;
};

std::vector<PinEvent> eventsOf(const std::filesystem::path& child) {
  ChildSourceOptions options;
  options.child = child;
  options.image = kImage;
  const auto source = openChild(options);
  std::vector<PinEvent> events;
  Batch batch;
  for (Tick until = 8000; until <= 160'000; until += 8000) {
    EXPECT_EQ(source->advance(until, batch), Stop::kReached) << source->message();
    events.insert(events.end(), batch.events.begin(), batch.events.end());
  }
  return events;
}

TEST(ChildConnection, AnEmulatorElsewhereGivesTheSameEvents) {
  const Server server(KERFBENCH_AVR_CHILD);
  const std::vector<PinEvent> there = eventsOf(server.address());
  EXPECT_GT(there.size(), 400U);
  EXPECT_EQ(there, eventsOf(KERFBENCH_AVR_CHILD));
}

TEST(ChildConnection, OneThatHangsUpIsTold) {
  const Server server("");
  EXPECT_THAT([&] { (void)eventsOf(server.address()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("closed the connection")));
}

TEST(ChildConnection, APortWhereNobodyListensIsAnErrorThatNamesIt) {
  // A port that was free a moment ago.
  base::UniqueFd taken(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::bind(taken.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  socklen_t size = sizeof address;
  ASSERT_EQ(::getsockname(taken.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string port = std::to_string(ntohs(address.sin_port));
  EXPECT_THAT([&] { (void)openChannel("tcp:127.0.0.1:" + port); },
              ThrowsMessage<std::system_error>(HasSubstr("127.0.0.1:" + port + ": Connection refused")));
}

TEST(ChildConnection, AnAddressThatIsNoneIsRefused) {
  for (const char* address : {"tcp:", "tcp:host", "tcp::99", "tcp:host:"}) {
    EXPECT_THAT([&] { (void)openChannel(address); },
                ThrowsMessage<std::runtime_error>(HasSubstr("no address like tcp:HOST:PORT")))
        << address;
  }
  EXPECT_FALSE(isConnection("tcp-emulator/child"));
}

}  // namespace
}  // namespace kerfbench::source
