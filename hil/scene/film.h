// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "hil/scene/film_writer.h"
#include "hil/scene/picture.h"

namespace kerfbench::scene {

/// The machine at a time. May be called by several threads at once.
using SceneAt = std::function<twin::Scene(double time_s)>;

/// What of a run a film shows, and how fast.
struct FilmSpan {
  double from_s{}, to_s{};
  double slow{1.0};              ///< A second of the run takes so many of the film; > 0.
  double pictures_each_s{25.0};  ///< Pictures a second of the film; > 0.

  [[nodiscard]] std::size_t pictures() const;  ///< At least 1; the first is at from_s, none behind to_s.
  [[nodiscard]] double timeOf_s(std::size_t picture) const;
};

/// The span that a machine takes to come back to where it was: of a gantry, forth and back once, from one of
/// its turns to the next on the same side; of a head that stands still, what the laser cuts in a `period_s`
/// (time between two units; 0: all that it cuts). Looks at the scene every hundredth of the time, or more
/// often. The whole time if nothing moves.
FilmSpan cycleOf(const SceneAt& scene_at, double end_s, double period_s);

/// Makes a film, drawn (PictureQuality::kDrawn) on up to `threads` threads. The viewpoint of a picture of the
/// whole stands still. `told` is called with the number of pictures that are done.
/// @throws as FilmWriter and renderPng().
void makeFilm(const SceneAt& scene_at, const FilmSpan& span, const PictureOptions& picture, int threads,
              FilmWriter& film, const std::function<void(std::size_t done)>& told);

}  // namespace kerfbench::scene
