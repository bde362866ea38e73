// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/povray.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <thread>

#include "hil/base/atomic_file.h"
#include "hil/base/file_content.h"
#include "hil/base/spawn_setup.h"
#include "hil/base/temporary.h"
#include "hil/scene/child_program.h"

namespace kerfbench::scene {
namespace {

namespace fs = std::filesystem;

// Settings of POV-Ray, all of them, so that nothing is left to the files of the host or the user.
std::string iniText(const PovrayOptions& options) {
  return fmt::format(
      "Input_File_Name=scene.pov\nOutput_File_Name=picture.png\nOutput_to_File=On\nOutput_File_Type=N8\n"
      "Width={}\nHeight={}\nDisplay=Off\nVerbose=Off\nPause_When_Done=Off\nWork_Threads=1\nQuality=9\n"
      "Antialias=On\nSampling_Method=2\nAntialias_Threshold=0.15\nAntialias_Depth=2\nJitter=Off\n"
      "Output_Alpha=Off\nFile_Gamma=sRGB\nDither=Off\nBounding=On\n",
      options.width_px, options.height_px);
}

// The lines that name the fault; everything else POV-Ray says is statistics, and progress that overwrites
// itself.
std::string faultIn(const std::string& log) {
  std::string fault;
  std::string line;
  for (const char c : log + "\n") {
    if (c != '\n' && c != '\r') {
      line += c;
      continue;
    }
    const auto says = [&](const char* word) { return line.find(word) != std::string::npos; };
    const bool named = says("rror:") || says("roblem") || says("ailed") || says("annot");
    if (named && !says("user configuration file")) fault += (fault.empty() ? "" : " | ") + line;
    line.clear();
  }
  constexpr std::size_t kShown = 600;
  return fault.empty() ? "it does not say why" : fault.substr(0, kShown);
}

pid_t spawnIn(const fs::path& folder, const fs::path& program) {
  base::SpawnSetup setup;
  const std::string log = (folder / "log").string();
  ::posix_spawn_file_actions_addopen(&setup.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
  ::posix_spawn_file_actions_addchdir_np(&setup.actions, folder.c_str());
  setup.setSignals(false);
  std::vector<std::string> command = base::endingWithParent({program.string(), "picture.ini"});
  const std::vector<char*> arguments = base::pointersTo(command);
  // A home of its own: the user's settings stay out, and so does the complaint that there are none. POVINI
  // takes the place of the host's settings.
  std::string home = "HOME=" + folder.string();
  std::string settings = "POVINI=" + (folder / "picture.ini").string();
  std::string locale = "LC_ALL=C";
  char* const environment[] = {home.data(), settings.data(), locale.data(), nullptr};
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, arguments.front(), &setup.actions, &setup.attributes,
                                  arguments.data(), environment);
  if (error != 0) throw std::system_error(error, std::generic_category(), program.string());
  return pid;
}

// nullopt: it had to be stopped.
std::optional<int> waitFor(pid_t pid, double patience_s) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(patience_s);
  int status = 0;
  for (;;) {
    const pid_t ended = ::waitpid(pid, &status, WNOHANG);
    if (ended == pid) return status;
    if (ended < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
    if (Clock::now() >= deadline) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::kill(pid, SIGKILL);
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return std::nullopt;
}

}  // namespace

bool povrayFound(const fs::path& program) { return findProgram(program).has_value(); }

std::vector<std::uint8_t> runPovray(const std::string& scene, const PovrayOptions& options) {
  constexpr int kLargest_px = 8192;
  if (options.width_px < 1 || options.width_px > kLargest_px || options.height_px < 1 ||
      options.height_px > kLargest_px) {
    throw PictureError(fmt::format("a picture of {} x {} pixels cannot be made: 1 … {} each way",
                                   options.width_px, options.height_px, kLargest_px));
  }
  const auto program = findProgram(options.program);
  if (!program) {
    throw PictureError(
        fmt::format("pictures need POV-Ray, and there is no program {}: install it (apt-get install povray)",
                    options.program.string()));
  }
  const base::TemporaryFolder folder(fs::temp_directory_path(), "kerfbench-picture");
  base::writeFileAtomically(folder.path() / "scene.pov", scene);
  base::writeFileAtomically(folder.path() / "picture.ini", iniText(options));
  const auto status = waitFor(spawnIn(folder.path(), *program), options.patience_s);
  if (!status) {
    throw PictureError(fmt::format("{} was stopped after {:g} s", program->string(), options.patience_s));
  }
  const std::string log = base::fileContent(folder.path() / "log").value_or("");
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0) {
    const std::string how = WIFSIGNALED(*status)
                                ? fmt::format("was ended by signal {}", ::strsignal(WTERMSIG(*status)))
                                : fmt::format("ended with exit status {}", WEXITSTATUS(*status));
    throw PictureError(fmt::format("{} {}: {}", program->string(), how, faultIn(log)));
  }
  const std::string bytes = base::fileContent(folder.path() / "picture.png").value_or("");
  if (bytes.empty())
    throw PictureError(fmt::format("{} wrote no picture: {}", program->string(), faultIn(log)));
  return {bytes.begin(), bytes.end()};
}

}  // namespace kerfbench::scene
