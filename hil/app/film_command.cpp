// SPDX-License-Identifier: Apache-2.0
#include "hil/app/film_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>

#include "hil/app/filmed_run.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/input_file.h"
#include "hil/base/terminal.h"
#include "hil/judge/machine_pictures.h"
#include "hil/scenario/case.h"
#include "hil/scene/film.h"
#include "hil/trace/run/trace_scenes.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

/// A film of more is a mistake: at a picture in a tenth of a second it takes an hour.
constexpr std::size_t kMostPictures = 36'000;
/// So much of a trace is looked through for a cycle: the rows of motion of two minutes take 40 MB.
constexpr double kLookedThrough_s = 120.0;

int refuse(const std::string& why) {
  base::toTerminal(stderr, "show: " + why + "\n");
  return base::kExitUsage;
}

std::string tooLong(std::size_t pictures) {
  return fmt::format(
      "a film of {} pictures is too long; take a shorter span (--from, --to), or less of --slow or --fps",
      pictures);
}

bool isTrace(const fs::path& path) {
  const base::OpenedInput file = base::openInput(path, base::kAnySize);
  std::string begin(trace::kMcapMagic.size(), '\0');
  return file.refusal.empty() && ::pread(file.fd.get(), begin.data(), begin.size(), 0) == std::ssize(begin) &&
         begin == trace::kMcapMagic;
}

/// What of a run is filmed, and what it is called.
struct Filmed {
  scene::SceneAt scene_at;
  double end_s{};
  double unit_period_s{};
  std::string name;
};

int makeFilmOf(const Filmed& run, const ShowOptions& options, base::Console& console) {
  scene::FilmSpan span{options.from_s.value_or(0.0), std::min(options.to_s.value_or(run.end_s), run.end_s)};
  if (!options.from_s && !options.to_s) {
    console.progress(-1.0, "looking for a cycle");
    span = scene::cycleOf(run.scene_at, run.end_s, run.unit_period_s);
  }
  span.slow = options.slow;
  span.pictures_each_s = options.pictures_each_s;
  if (span.from_s > run.end_s)
    throw base::InputError(fmt::format("show: the run ended at {:.4f} s, before --from", run.end_s));
  const std::size_t pictures = span.pictures();
  if (pictures > kMostPictures) return refuse(tooLong(pictures));
  console.say(fmt::format("{}: {:.4f} … {:.4f} s, {:g} times slower, {} pictures", run.name, span.from_s,
                          span.to_s, span.slow, pictures));
  scene::FilmWriter film(options.film, {.pictures_each_s = span.pictures_each_s});
  scene::makeFilm(run.scene_at, span, pictureOptions(options), options.threads, film, [&](std::size_t done) {
    console.progress(-1.0,
                     fmt::format("drawing {} of {} pictures, {} %", done, pictures, 100 * done / pictures));
  });
  film.finish();
  console.endProgress();
  console.result(options.film.string());
  return 0;
}

int filmOfTrace(const ShowOptions& options, base::Console& console) {
  trace::TraceSpan span;
  span.from_s = options.from_s.value_or(0.0);
  span.to_s = options.to_s.value_or(options.from_s ? span.to_s : kLookedThrough_s);
  console.progress(-1.0, "reading " + options.subject.string());
  const trace::TraceScenes scenes(options.subject, span);
  const auto scene_at = [&scenes](double time_s) { return scenes.at(time_s); };
  if (scenes.end_s() <= 0.0)
    throw base::InputError(fmt::format("show: in {} nothing moves in that time", options.subject.string()));
  return makeFilmOf({scene_at, scenes.end_s(), scenes.unitPeriod_s(), scenes.scenario()}, options, console);
}

int filmOfScenario(const fs::path& path, const ShowOptions& options, base::Console& console) {
  const scenario::Case test_case = scenario::readCase(path, options.bin_dir.parent_path() / "firmware");
  const scenario::Scenario& scenario = test_case.scenario;
  if (!options.scenario.empty() && !options.subject.empty() &&
      fs::weakly_canonical(options.subject) != fs::weakly_canonical(scenario.machine))
    return refuse(fmt::format("{} runs on {}, not on {}", path.string(), scenario.machine.string(),
                              options.subject.string()));
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  const run::MachineFilm film = filmedRun(test_case, sampled, options.to_s, options.bin_dir, console);
  const twin::WebDescription web = scenario::webOn(sampled.machine, test_case);
  const Eigen::AlignedBox2d unit = judge::unitOf(*test_case.dieline);
  const auto scene_at = [&](double time_s) { return film.sceneAt(time_s, sampled.machine, web, unit); };
  const bool repeats = scenario.belt_speed_mm_s > 0.0 && scenario.print.units > 1;
  const double period_s = repeats ? scenario.print.pitch_mm / scenario.belt_speed_mm_s : 0.0;
  return makeFilmOf({scene_at, film.end_s(), period_s, scenario.name}, options, console);
}

}  // namespace

scene::PictureOptions pictureOptions(const ShowOptions& options) {
  scene::PictureOptions picture;
  picture.width_px = options.width_px;
  picture.height_px = options.height_px;
  picture.view = options.view == "head"    ? scene::SceneView::kHead
                 : options.view == "sheet" ? scene::SceneView::kSheet
                                           : scene::SceneView::kOverall;
  return picture;
}

int showFilm(const ShowOptions& options) {
  if (!options.at_s.empty() || !options.out.empty())
    return refuse("a film is named by --film and shows --from … --to; --at and --out are for pictures");
  if (!scene::isFilmName(options.film))
    return refuse(fmt::format("a film is written as .mp4 or .webm, not as {}", options.film.string()));
  if (options.from_s && options.to_s && !(*options.to_s > *options.from_s))
    return refuse("--to is not behind --from");
  if (options.to_s) {
    const scene::FilmSpan span{options.from_s.value_or(0.0), *options.to_s, options.slow,
                               options.pictures_each_s};
    if (span.pictures() > kMostPictures) return refuse(tooLong(span.pictures()));
  }
  if (!scene::ffmpegFound()) {
    base::toTerminal(stderr, "show: films need FFmpeg: install it (apt-get install ffmpeg)\n");
    return base::kExitBroken;
  }
  base::Console console(options.quiet);
  if (options.scenario.empty() && isTrace(options.subject)) return filmOfTrace(options, console);
  return filmOfScenario(options.scenario.empty() ? options.subject : options.scenario, options, console);
}

}  // namespace kerfbench::app
