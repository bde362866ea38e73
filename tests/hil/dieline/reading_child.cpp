// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/dieline/reading_child.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::dieline {
namespace {

ReadingChild runMeasuring(const std::string& option, const std::string& path) {
  const std::string program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "measure-drawings").string();
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) ADD_FAILURE() << "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit cpu{10, 10};
    ::setrlimit(RLIMIT_CPU, &cpu);
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::execl(program.c_str(), program.c_str(), option.c_str(), path.c_str(), static_cast<char*>(nullptr));
    std::_Exit(127);
  }
  ::close(ends[1]);
  ReadingChild result;
  char part[4096];
  for (ssize_t n = 0; (n = ::read(ends[0], part, sizeof part)) > 0;)
    result.said.append(part, static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  result.cpu_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  // What getrusage says of a child is no less than what the parent had when it forked.
  const std::size_t peak = result.said.rfind("peak ");
  if (peak != std::string::npos) result.peak_mib = std::stod(result.said.substr(peak + 5)) / 1024;
  result.said.resize(std::min(peak, result.said.size()));
  return result;
}

}  // namespace

ReadingChild readInChild(const std::filesystem::path& path) { return runMeasuring("--peak", path.string()); }

bool childIsWatched() {
  static const bool is_watched = runMeasuring("--is-watched", "").exit_code == 0;
  return is_watched;
}

void expectRefusedInTime(const std::filesystem::path& path, const std::string& name,
                         const std::string& sentence, double most_mib, double most_s) {
  const ReadingChild child = readInChild(path);
  EXPECT_EQ(child.exit_code, 1) << name;
  EXPECT_THAT(child.said, testing::HasSubstr(sentence)) << name;
  EXPECT_EQ(std::count(child.said.begin(), child.said.end(), '\n'), 1)
      << name << ": " << child.said.substr(0, 500);
  if (childIsWatched()) return;
  EXPECT_LE(child.cpu_s, most_s) << name;
  EXPECT_GT(child.peak_mib, 0.0) << name;
  EXPECT_LE(child.peak_mib, most_mib) << name;
}

}  // namespace kerfbench::dieline
