// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/film_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "hil/base/file_content.h"
#include "hil/base/spawn_setup.h"
#include "hil/base/text.h"
#include "hil/scene/child_program.h"

namespace kerfbench::scene {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLog = "log";

std::string endOf(const fs::path& film) { return base::lowered(film.extension().string()); }

fs::path folderOf(const fs::path& film) {
  const fs::path folder = fs::absolute(film).parent_path();
  if (!fs::is_directory(folder))
    throw std::system_error(ENOENT, std::generic_category(), "cannot write " + film.string());
  return folder;
}

/// Options of FFmpeg: pictures from its standard input, the same film of the same pictures, nothing of the
/// host in it. Encoders of H.264 take colours of half the resolution and so even sizes alone.
std::vector<std::string> commandOf(const fs::path& program, const FilmOptions& options,
                                   const std::string& made) {
  std::vector<std::string> words{program.string(),
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-nostdin",
                                 "-y",
                                 "-f",
                                 "image2pipe",
                                 "-framerate",
                                 fmt::format("{:.6g}", options.pictures_each_s),
                                 "-c:v",
                                 "png",
                                 "-i",
                                 "pipe:0",
                                 "-an",
                                 "-map_metadata",
                                 "-1",
                                 "-fflags",
                                 "+bitexact",
                                 "-flags:v",
                                 "+bitexact",
                                 "-vf",
                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,format=yuv420p"};
  const std::vector<std::string> encoder =
      made.ends_with(".webm")
          ? std::vector<std::string>{"-c:v", "libvpx-vp9", "-b:v", "0",         "-crf",
                                     "30",   "-deadline",  "good", "-cpu-used", "4"}
          : std::vector<std::string>{"-c:v", "libx264", "-crf", "20", "-movflags", "+faststart"};
  words.insert(words.end(), encoder.begin(), encoder.end());
  words.push_back(made);
  return words;
}

int waitFor(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  return status;
}

}  // namespace

bool ffmpegFound(const fs::path& program) { return findProgram(program).has_value(); }

bool isFilmName(const fs::path& name) { return endOf(name) == ".mp4" || endOf(name) == ".webm"; }

FilmWriter::FilmWriter(fs::path film, FilmOptions options)
    : film_(std::move(film)), options_(std::move(options)), folder_(folderOf(film_), ".kerfbench-film") {
  if (!isFilmName(film_))
    throw PictureError(fmt::format("a film is written as .mp4 or .webm, not as {}", film_.string()));
  const std::optional<fs::path> program = findProgram(options_.program);
  if (!program)
    throw PictureError(
        fmt::format("films need FFmpeg, and there is no program {}: install it (apt-get install ffmpeg)",
                    options_.program.string()));
  // A socket, so that a write to a program that has gone raises no signal, and does not last for ever.
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), "socketpair");
  pictures_ = base::UniqueFd(ends[0]);
  const base::UniqueFd input(ends[1]);
  const timeval patience{static_cast<time_t>(std::ceil(options_.patience_s)), 0};
  if (::setsockopt(pictures_.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience) != 0)
    throw std::system_error(errno, std::generic_category(), "setsockopt");
  start(*program, input.get());
}

FilmWriter::~FilmWriter() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
}

void FilmWriter::start(const fs::path& program, int input) {
  base::SpawnSetup setup;
  const std::string log = (folder_.path() / kLog).string();
  ::posix_spawn_file_actions_adddup2(&setup.actions, input, STDIN_FILENO);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&setup.actions, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
  ::posix_spawn_file_actions_addchdir_np(&setup.actions, folder_.path().c_str());
  setup.setSignals(false);
  std::vector<std::string> command =
      base::endingWithParent(commandOf(program, options_, made().filename().string()));
  const std::vector<char*> arguments = base::pointersTo(command);
  std::string home = "HOME=" + folder_.path().string();
  std::string locale = "LC_ALL=C";
  char* const environment[] = {home.data(), locale.data(), nullptr};
  const int error = ::posix_spawn(&pid_, arguments.front(), &setup.actions, &setup.attributes,
                                  arguments.data(), environment);
  if (error == 0) return;
  pid_ = -1;
  throw std::system_error(error, std::generic_category(), program.string());
}

fs::path FilmWriter::made() const { return folder_.path() / ("film" + endOf(film_)); }

std::string FilmWriter::fault() const {
  constexpr std::size_t kShown = 600;
  const std::string said = base::fileContent(folder_.path() / kLog).value_or("");
  return said.empty() ? "it does not say why" : said.substr(0, kShown);
}

void FilmWriter::add(std::span<const std::uint8_t> png) {
  while (!png.empty()) {
    const ssize_t sent = ::send(pictures_.get(), png.data(), png.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
      throw PictureError(fmt::format("{} has taken no picture for {:g} s: {}", options_.program.string(),
                                     options_.patience_s, fault()));
    if (sent < 0) {
      const int status = waitFor(std::exchange(pid_, -1));
      throw PictureError(fmt::format("{} ended before the film did (status {}): {}",
                                     options_.program.string(), status, fault()));
    }
    png = png.subspan(static_cast<std::size_t>(sent));
  }
}

void FilmWriter::finish() {
  pictures_.reset();
  const int status = waitFor(std::exchange(pid_, -1));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw PictureError(fmt::format("{} failed: {}", options_.program.string(), fault()));
  const base::UniqueFd film(::open(made().c_str(), O_RDONLY | O_CLOEXEC));
  if (!film.valid())
    throw PictureError(fmt::format("{} wrote no film: {}", options_.program.string(), fault()));
  if (::fsync(film.get()) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot write " + film_.string());
  fs::rename(made(), film_);
}

}  // namespace kerfbench::scene
