// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hil/serve/front_door.h"
#include "hil/serve/window.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/serve/client.h"

namespace kerfbench::serve {

/// A bench that was installed, as far as the window needs it: pages of one line, one example, and a program
/// `kerfbench` in the shell, which acts as a run does.
class InstalledBench {
 public:
  InstalledBench() {
    namespace fs = std::filesystem;
    for (const char* folder : {"lib/kerfbench/bin", "lib/kerfbench/firmware", "lib/kerfbench/window",
                               "share/kerfbench/scenarios", "work"})
      fs::create_directories(root_.path() / folder);
    (void)root_.write("lib/kerfbench/window/index.html",
                      "<!doctype html><title>Kerfbench</title>{{nonce}}\n");
    (void)root_.write("lib/kerfbench/window/main.js", "export {};\n");
    (void)root_.write("share/kerfbench/scenarios/label.yaml",
                      "name: label\ntitle: A label\nmachine: m.yaml\ndieline: d.dxf\n");
    program("exit 0");
  }

  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return root_.path() / name; }
  /// Folder of the user.
  [[nodiscard]] std::filesystem::path work() const { return path("work"); }
  void write(const std::string& name, const std::string& content) const { (void)root_.write(name, content); }
  /// Lines of a shell for `kerfbench`; $events is the file of events.
  void program(const std::string& lines) const {
    namespace fs = std::filesystem;
    write(
        "lib/kerfbench/bin/kerfbench",
        "#!/bin/sh\nwhile [ $# -gt 0 ]; do [ \"$1\" = --events ] && events=$2; shift; done\n" + lines + "\n");
    fs::permissions(path("lib/kerfbench/bin/kerfbench"), fs::perms::owner_all);
  }

 private:
  base::TempFolder root_;
};

/// A server in this process, on a port of its own.
class Served {
 public:
  explicit Served(const InstalledBench& bench, const DoorLimits& limits = {},
                  const std::string& address = "127.0.0.1")
      : Served(bench, bench.path("lib/kerfbench/bin"), limits, address) {}
  /// With the programs, releases and examples of another bench.
  Served(const InstalledBench& bench, const std::filesystem::path& bin_dir, const DoorLimits& limits = {},
         const std::string& address = "127.0.0.1")
      : door_({address, 0}, limits),
        window_({bench.work(), bin_dir, bench.path("lib/kerfbench/window"), shippedFolders(bin_dir)},
                door_.address(),
                [this](const std::string& token) {
                  const std::lock_guard lock(mutex_);
                  tokens_.push_back(token);
                }),
        thread_([this] { door_.run(window_); }) {}
  ~Served() {
    door_.stop();
    thread_.join();
    window_.stop();
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;

  [[nodiscard]] int port() const { return door_.address().port; }
  [[nodiscard]] std::string token() const {
    const std::lock_guard lock(mutex_);
    return tokens_.back();
  }
  /// One who was let in.
  [[nodiscard]] Client client() const {
    Client client(port());
    client.logIn(token());
    return client;
  }
  [[nodiscard]] Client stranger() const { return Client(port()); }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> tokens_;
  FrontDoor door_;
  Window window_;
  std::thread thread_;
};

}  // namespace kerfbench::serve
