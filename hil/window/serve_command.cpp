// SPDX-License-Identifier: Apache-2.0
#include "hil/window/serve_command.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/unique_fd.h"
#include "hil/batch/stop_signals.h"
#include "hil/serve/window.h"

namespace kerfbench::window {
namespace {

namespace fs = std::filesystem;

void tell(const std::string& line) {
  base::toTerminal(stdout, line + "\n");
  std::fflush(stdout);
}

/// Addresses of this computer by which others reach it, IPv4.
std::vector<std::string> ownAddresses() {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, ::freeifaddrs);
  std::vector<std::string> found;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in v4{};
    std::memcpy(&v4, each->ifa_addr, sizeof v4);
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
    if (!serve::isLoopback(text.data())) found.emplace_back(text.data());
  }
  return found;
}

/// Addresses at which the server is reached, the best first.
std::vector<serve::ServerAddress> reachedAt(const serve::ServerAddress& bound) {
  if (bound.address != "0.0.0.0" && bound.address != "::") return {bound};
  std::vector<serve::ServerAddress> all;
  for (const std::string& address : ownAddresses()) all.push_back({address, bound.port});
  all.push_back({bound.address == "::" ? "::1" : "127.0.0.1", bound.port});
  return all;
}

/// Page that is opened: path, further query, and what stands behind '#'.
struct Opened {
  std::string path{"/"}, query, fragment;

  [[nodiscard]] std::string link(const serve::ServerAddress& address, const std::string& token) const {
    return fmt::format("http://{}{}?token={}{}{}", serve::hostAndPort(address), path, token, query, fragment);
  }
};

void startBrowser(const std::string& link) {
  // A process of its own, which lives on when the server ends.
  std::array<std::string, 4> words{"setsid", "-f", "xdg-open", link};
  std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  pid_t pid = 0;
  int status = 0;
  if (::posix_spawnp(&pid, words[0].c_str(), nullptr, nullptr, arguments.data(), environ) == 0)
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
}

void warnOfOthers(const serve::ServerAddress& address) {
  if (serve::isLoopback(address.address)) return;
  tell(fmt::format(
      "This server listens at {}, so that other computers reach it. Whoever has the link can read and write "
      "this folder\nand start programs as you; nothing is encrypted, so whoever sees the network's traffic "
      "has "
      "it too.",
      serve::hostAndPort(address)));
}

/// Ends `door` at a signal; ends itself with the scope.
class SignalWatch {
 public:
  SignalWatch(batch::StopSignals& signals, serve::FrontDoor& door)
      : end_(::eventfd(0, EFD_CLOEXEC)), thread_([this, &signals, &door] {
          std::array<pollfd, 2> pollers{{{signals.fd(), POLLIN, 0}, {end_.get(), POLLIN, 0}}};
          while (::poll(pollers.data(), pollers.size(), -1) < 0 && errno == EINTR) {
          }
          // One that is not taken would end the process when it is no longer blocked.
          if (signals.take()) door.stop();
        }) {}
  ~SignalWatch() {
    const std::uint64_t one = 1;
    (void)!::write(end_.get(), &one, sizeof one);
    thread_.join();
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

 private:
  base::UniqueFd end_;
  std::thread thread_;
};

int serveAt(const ServeOptions& options, const Opened& opened) {
  // Before any thread is made.
  batch::StopSignals signals;
  (void)::signal(SIGPIPE, SIG_IGN);  // Whoever reads what is printed may go.
  serve::FrontDoor door({options.address, options.port}, {});
  const serve::ServerAddress address = door.address();
  const std::vector<serve::ServerAddress> reached = reachedAt(address);
  warnOfOthers(address);
  bool is_first = true;
  std::string first_link;
  const auto tell_link = [&](const std::string& token) {
    if (is_first) first_link = opened.link(reached.front(), token);
    for (const serve::ServerAddress& each : reached)
      tell((is_first ? "" : "for another browser: ") + opened.link(each, token));
    is_first = false;
  };
  const fs::path folder = fs::canonical(options.folder);
  std::vector<serve::BenchAddress> benches;
  for (const std::string& bench : options.benches) benches.push_back(serve::benchAddressFrom(bench));
  serve::Window window({folder, options.bin_dir, options.bin_dir / ".." / "window",
                        serve::shippedFolders(options.bin_dir), std::move(benches)},
                       address, tell_link);
  if (options.open) startBrowser(first_link);
  {
    const SignalWatch watch(signals, door);
    door.run(window);
  }
  window.stop();
  return 0;
}

/// Bad input of the user in his words.
template <typename Work>
int guarded(const Work& work) {
  try {
    return work();
  } catch (const base::InputError& e) {
    base::toTerminal(stderr, fmt::format("{}\n", e.what()));
  } catch (const fs::filesystem_error& e) {
    base::toTerminal(stderr, fmt::format("{}: {}\n", e.path1().string(), e.code().message()));
  }
  return base::kExitInput;
}

}  // namespace

int serveCommand(const ServeOptions& options) {
  return guarded([&] { return serveAt(options, {}); });
}

int viewCommand(const ViewOptions& options) {
  return guarded([&] {
    if (!fs::is_regular_file(options.trace))
      throw base::InputError(fmt::format("{}: no such file", options.trace.string()));
    if (options.trace.extension() != ".mcap")
      throw base::InputError(fmt::format("{}: the name of a trace ends in .mcap", options.trace.string()));
    const fs::path trace = fs::canonical(options.trace);
    ServeOptions serve = options.serve;
    serve.folder = fs::current_path();
    fs::path name = trace.lexically_relative(fs::canonical(serve.folder));
    if (name.empty() || *name.begin() == ".." || !serve::isReadableName(name.generic_string())) {
      serve.folder = trace.parent_path();
      name = trace.filename();
    }
    Opened opened{"/view", "&trace=" + serve::percentEncoded(name.generic_string()), ""};
    if (options.at_s) opened.fragment = fmt::format("#t={}", *options.at_s);
    return serveAt(serve, opened);
  });
}

}  // namespace kerfbench::window
