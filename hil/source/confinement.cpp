// SPDX-License-Identifier: Apache-2.0
#include "hil/source/confinement.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "hil/base/spawn_setup.h"

extern char** environ;

namespace kerfbench::source {
namespace {

namespace fs = std::filesystem;

// Where Debian has them: a search through PATH would run what a folder of somebody else's holds.
constexpr const char* kBubblewrap = "/usr/bin/bwrap";
#ifdef KERFBENCH_SANITIZED
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
constexpr const char* kPrlimit = "/usr/bin/prlimit";

std::vector<std::string> emptyRoom() {
  std::vector<std::string> words{
      kBubblewrap,  "--unshare-all", "--die-with-parent", "--new-session", "--clearenv",
      "--cap-drop", "ALL",           "--ro-bind",         "/usr",          "/usr"};
  for (const char* folder : {"/bin", "/lib", "/lib64"}) {
    std::error_code none;
    if (fs::is_symlink(folder, none)) {
      words.insert(words.end(), {"--symlink", fs::read_symlink(folder, none).string(), folder});
    } else {
      words.insert(words.end(), {"--ro-bind-try", folder, folder});
    }
  }
  words.insert(words.end(), {"--ro-bind-try", "/etc/alternatives", "/etc/alternatives", "--ro-bind-try",
                             "/etc/ld.so.cache", "/etc/ld.so.cache", "--dev", "/dev", "--tmpfs", "/tmp"});
  return words;
}

/// Exit status of a command that says nothing; -1: it did not start.
int quietly(std::vector<std::string> command) {
  base::SpawnSetup setup;
  ::posix_spawn_file_actions_addopen(&setup.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  setup.setSignals(false);
  const std::vector<char*> arguments = base::pointersTo(command);
  pid_t pid = -1;
  if (::posix_spawn(&pid, command.front().c_str(), &setup.actions, &setup.attributes, arguments.data(),
                    environ) != 0)
    return -1;
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string tryBubblewrap() {
  if (kSanitized) return "this build has the sanitizers, which need files and terabytes of addresses";
  if (::access(kBubblewrap, X_OK) != 0) return "bubblewrap is not installed";
  std::vector<std::string> probe = emptyRoom();
  probe.emplace_back("/usr/bin/true");
  return quietly(std::move(probe)) == 0 ? "" : "bubblewrap may not make namespaces on this computer";
}

void bindReadable(std::vector<std::string>& words, const fs::path& path) {
  words.insert(words.end(), {"--ro-bind", path.string(), path.string()});
}

}  // namespace

const std::string& troubleOfBubblewrap() {
  static const std::string trouble = tryBubblewrap();
  return trouble;
}

Confinement confinementOf(const fs::path& program, const std::vector<fs::path>& readable) {
  Confinement confinement;
  confinement.open_because = troubleOfBubblewrap();
  auto& words = confinement.launcher;
  if (!kSanitized && ::access(kPrlimit, X_OK) == 0) {
    words = {kPrlimit, "--as=" + std::to_string(kConfinedAddressSpace_bytes), "--core=0", "--"};
  }
  if (!confinement.open_because.empty()) {
    if (!words.empty()) words = base::endingWithParent(std::move(words));
    return confinement;
  }
  for (std::string& word : emptyRoom()) words.push_back(std::move(word));
  bindReadable(words, program.parent_path());
  for (const fs::path& file : readable) bindReadable(words, file);
  words.emplace_back("--");
  return confinement;
}

}  // namespace kerfbench::source
