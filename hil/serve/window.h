// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/serve/access.h"
#include "hil/serve/answer.h"
#include "hil/serve/arrivals.h"
#include "hil/serve/desk_routes.h"
#include "hil/serve/file_list.h"
#include "hil/serve/front_door.h"
#include "hil/serve/http_server.h"
#include "hil/serve/neighbours.h"
#include "hil/serve/runs.h"
#include "hil/serve/work_folder.h"

namespace kerfbench::serve {

/// Bytes of a file that is written, and of what is asked as JSON.
inline constexpr std::uint64_t kMostFileBytes = std::uint64_t{64} << 20U;
inline constexpr std::uint64_t kMostJsonBytes = std::uint64_t{16} << 20U;
/// Answers at a time that go on until something ends: a run's events, its trace.
inline constexpr int kMostStreams = 64;

/// Where the window's parts are.
struct WindowSetup {
  std::filesystem::path folder;   ///< Absolute; in which the user works.
  std::filesystem::path bin_dir;  ///< With kerfbench.
  std::filesystem::path pages;    ///< Bundle of window/, with index.html.
  ShippedFolders shipped;
  std::vector<BenchAddress> benches{};  ///< Others, shown on the page of the station.
};

/// What the window's pages ask, and who may ask it. docs/reference/window-api.md has all of it.
class Window final : public Host {
 public:
  /// `token_made`: see Access. @throws base::InputError for a folder that cannot be read, or pages that are
  /// not there.
  Window(WindowSetup setup, ServerAddress address, std::function<void(const std::string&)> token_made);

  bool admit(const HttpHead& head) override;
  bool serve(Connection& connection, const HttpHead& head, bool is_known) override;
  /// Ends what goes on: streams, runs.
  void stop();

 private:
  struct Route {
    std::string method, path;
    Answer (Window::*answer)(const Asked& asked);
  };
  static const std::vector<Route>& routes();

  Answer answer(const Asked& asked);
  Answer answerApi(const Asked& asked);
  Answer answerRun(const Asked& asked);
  Answer page(const Asked& asked);
  Answer bundled(const Asked& asked);
  Answer results(const Asked& asked);

  Answer session(const Asked& asked);
  Answer listFiles(const Asked& asked);
  Answer putFile(const Asked& asked);
  Answer fileContent(const Asked& asked);
  Answer putScenario(const Asked& asked);
  Answer addRun(const Asked& asked);
  Answer listRuns(const Asked& asked);
  Answer traceFile(const Asked& asked);
  Answer service(const Asked& asked);
  Answer station(const Asked& asked);
  Answer benches(const Asked& asked);
  Answer reference(const Asked& asked) { return desk_.reference(asked); }
  Answer check(const Asked& asked) { return desk_.check(asked); }
  Answer edit(const Asked& asked) { return desk_.edit(asked); }
  Answer plan(const Asked& asked) { return desk_.plan(asked); }
  Answer order(const Asked& asked) { return desk_.order(asked); }
  Answer create(const Asked& asked) { return desk_.create(asked); }
  Answer place(const Asked& asked) { return desk_.place(asked); }

  /// An answer that goes on. @throws Refusal 503 if there are kMostStreams already.
  Answer streamed(std::unique_ptr<AnswerBody> body, const std::string& type);

  WindowSetup setup_;
  Access access_;
  WorkFolder files_;
  FileList list_;
  Runs runs_;
  DeskRoutes desk_;
  Arrivals arrivals_;
  Neighbours neighbours_;
  HttpServer http_;
  std::shared_ptr<std::atomic<int>> streams_{std::make_shared<std::atomic<int>>(0)};
};

}  // namespace kerfbench::serve
