// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "hil/base/temporary.h"
#include "hil/base/unique_fd.h"
#include "hil/scene/povray.h"

namespace kerfbench::scene {

struct FilmOptions {
  double pictures_each_s{25.0};  ///< Pictures a second of the film.
  /// The program: a name that is looked up in PATH, or a path.
  std::filesystem::path program{"ffmpeg"};
  /// Wall clock that the program may take for a picture before it is stopped.
  double patience_s{120.0};
};

/// Whether films can be made.
bool ffmpegFound(const std::filesystem::path& program = "ffmpeg");

/// Whether a film can have this name: its end says how it is encoded, .mp4 (H.264) or .webm (VP9).
bool isFilmName(const std::filesystem::path& name);

/// Makes a film of pictures, one after the other, by FFmpeg, which is fed while they come. The film is there
/// whole or not at all: it is written in a temporary folder beside its place, and moved there by finish().
class FilmWriter {
 public:
  /// @throws PictureError without FFmpeg, or for another name (see isFilmName()); std::system_error with the
  /// path if the film's folder cannot be written.
  FilmWriter(std::filesystem::path film, FilmOptions options);
  /// Ends FFmpeg if finish() was not reached; nothing is left then.
  ~FilmWriter();
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  /// The next picture, a PNG file's bytes; all have the size of the first. @throws PictureError with what
  /// FFmpeg says if it has ended or takes nothing more.
  void add(std::span<const std::uint8_t> png);
  /// Once. @throws PictureError with what FFmpeg says if it fails, std::system_error with the path.
  void finish();

 private:
  void start(const std::filesystem::path& program, int input);
  [[nodiscard]] std::string fault() const;
  [[nodiscard]] std::filesystem::path made() const;

  std::filesystem::path film_;
  FilmOptions options_;
  base::TemporaryFolder folder_;
  base::UniqueFd pictures_;
  pid_t pid_{-1};
};

}  // namespace kerfbench::scene
