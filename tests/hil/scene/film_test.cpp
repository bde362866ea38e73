// SPDX-License-Identifier: Apache-2.0
// Films by FFmpeg, which few computers that run the bench have: without it only the test that it is missed
// runs.
#include "hil/scene/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/scene/example_scene.h"

namespace kerfbench::scene {
namespace {

namespace fs = std::filesystem;

/// A head that goes along x as a function of time, and a laser that is lit from 2 s to 5 s.
SceneAt headAlong(double (*x_mm)(double)) {
  return [x_mm](double time_s) {
    twin::Scene scene;
    scene.time_s = time_s;
    scene.head = Eigen::AlignedBox3d(Eigen::Vector3d(x_mm(time_s) - 10, -5, 0),
                                     Eigen::Vector3d(x_mm(time_s) + 10, 5, 20));
    scene.beam_on = time_s >= 2.0 && time_s <= 5.0;
    return scene;
  };
}

TEST(FilmSpan, HasPicturesInEqualStepsAndNoneBehindItsEnd) {
  const FilmSpan span{1.0, 3.0, 10.0, 25.0};
  EXPECT_EQ(span.pictures(), 501U);
  EXPECT_DOUBLE_EQ(span.timeOf_s(0), 1.0);
  EXPECT_DOUBLE_EQ(span.timeOf_s(250), 2.0);
  EXPECT_DOUBLE_EQ(span.timeOf_s(500), 3.0);
  EXPECT_EQ((FilmSpan{2.0, 2.0}).pictures(), 1U);
}

TEST(Cycle, OfAGantryIsOnceForthAndBack) {
  // The head waits until 1 s, goes forth by 1.5 s, back by 2 s, waits, and comes again each 4 s.
  const SceneAt gantry = headAlong([](double time_s) {
    const double t = std::fmod(std::max(0.0, time_s - 1.0), 4.0);
    return t < 1.5 ? 200.0 * t : t < 3.5 ? 300.0 - 150.0 * (t - 1.5) : 0.0;
  });
  const FilmSpan cycle = cycleOf(gantry, 13.0, 0.0);
  EXPECT_NEAR(cycle.from_s, 1.0, 0.05);
  EXPECT_NEAR(cycle.to_s, 4.5, 0.05);
}

TEST(Cycle, OfAGantryThatDoesNotComeBackLastsToTheEnd) {
  const FilmSpan cycle = cycleOf(headAlong([](double t) { return 20.0 * std::max(0.0, t - 2.0); }), 8.0, 0.0);
  EXPECT_NEAR(cycle.from_s, 2.0, 0.05);
  EXPECT_DOUBLE_EQ(cycle.to_s, 8.0);
}

TEST(Cycle, OfAHeadThatStandsIsAUnitOfTheWeb) {
  const SceneAt head = headAlong([](double) { return 0.0; });
  EXPECT_NEAR(cycleOf(head, 9.0, 1.2).from_s, 2.0, 0.1);
  EXPECT_NEAR(cycleOf(head, 9.0, 1.2).to_s, 3.2, 0.1);
  EXPECT_NEAR(cycleOf(head, 9.0, 0.0).to_s, 5.0, 0.1);
}

TEST(FilmWriter, NamesThatItCanWrite) {
  EXPECT_TRUE(isFilmName("a.mp4"));
  EXPECT_TRUE(isFilmName("a.b/c.WEBM"));
  EXPECT_FALSE(isFilmName("a.gif"));
  EXPECT_FALSE(isFilmName("mp4"));
}

TEST(FilmWriter, SaysWhatToInstall) {
  const base::TempFolder folder;
  const fs::path film = folder.path() / "a.mp4";
  FilmOptions options;
  options.program = "/nonexistent/ffmpeg";
  try {
    const FilmWriter writer(film, options);
    FAIL() << "it has found a program";
  } catch (const PictureError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("apt-get install ffmpeg"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Scripted programs in place of FFmpeg: what it may do on somebody's computer.
class ScriptedFilm : public testing::Test {
 protected:
  [[nodiscard]] FilmOptions by(const std::string& script) const {
    FilmOptions options;
    options.program = temp_.write("ffmpeg", "#!/bin/sh\n" + script);
    fs::permissions(options.program, fs::perms::owner_all);
    return options;
  }
  /// What a film of a hundred pictures comes to.
  [[nodiscard]] std::string faultOf(const FilmOptions& options) const {
    const std::vector<std::uint8_t> picture(100'000, 7);
    try {
      FilmWriter writer(film(), options);
      for (int i = 0; i < 100; ++i) writer.add(picture);
      writer.finish();
    } catch (const PictureError& e) {
      return e.what();
    }
    return "";
  }
  [[nodiscard]] fs::path film() const { return films_ / "a.mp4"; }
  [[nodiscard]] std::ptrdiff_t filesBesideIt() const {
    return std::distance(fs::directory_iterator(films_), fs::directory_iterator());
  }
  void SetUp() override { fs::create_directories(films_); }

  const base::TempFolder temp_;
  const fs::path films_ = temp_.path() / "films";
};

TEST_F(ScriptedFilm, AllPicturesGoToItInOrderAndTheFilmTakesItsPlaceInTheEnd) {
  // The last word of the command is the file that is to be made.
  EXPECT_EQ(faultOf(by("for last; do :; done; cat > \"$last\"")), "");
  EXPECT_EQ(fs::file_size(film()), 10'000'000U);
  EXPECT_EQ(filesBesideIt(), 1);
}

TEST_F(ScriptedFilm, AProgramThatEndsEarlyIsAnErrorWithItsWordsAndLeavesNothing) {
  EXPECT_THAT(faultOf(by("echo 'Unknown encoder' >&2; exit 1")), testing::HasSubstr("Unknown encoder"));
  EXPECT_EQ(filesBesideIt(), 0);
}

TEST_F(ScriptedFilm, AProgramThatFailsAtTheEndLeavesNothing) {
  EXPECT_THAT(faultOf(by("cat > /dev/null; echo 'disk full' >&2; exit 1")), testing::HasSubstr("disk full"));
  EXPECT_THAT(faultOf(by("cat > /dev/null")), testing::HasSubstr("no film"));
  EXPECT_EQ(filesBesideIt(), 0);
}

TEST_F(ScriptedFilm, AFilmThatIsGivenUpLeavesNothingAndDoesNotReplaceTheOneThatIsThere) {
  const fs::path there = temp_.write("films/a.mp4", "an earlier film");
  {
    FilmWriter writer(there, by("for last; do :; done; cat > \"$last\""));
    writer.add(std::vector<std::uint8_t>(10, 1));
  }
  EXPECT_EQ(base::contentOf(there), "an earlier film");
  EXPECT_EQ(filesBesideIt(), 1);
}

/// What ffprobe tells of a film, in lines.
std::string probed(const std::string& arguments, const fs::path& film, const fs::path& out) {
  const std::string command =
      "ffprobe -v error -of csv=p=0 " + arguments + " '" + film.string() + "' > '" + out.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  return base::contentOf(out);
}

TEST(Film, HasThePicturesThatWereAskedForAndTheyMove) {
  if (!ffmpegFound()) GTEST_SKIP() << "FFmpeg is not installed (apt-get install ffmpeg)";
  const base::TempFolder folder;
  for (const char* name : {"a.mp4", "a.webm"}) {
    const fs::path path = folder.path() / name;
    PictureOptions picture;
    picture.width_px = 97;  // An odd width: the encoders take even ones.
    picture.height_px = 64;
    const SceneAt half_lit = [](double time_s) { return sceneWithBeam(time_s > 0.45); };
    std::size_t told = 0;
    FilmWriter film(path, {.pictures_each_s = 10.0});
    makeFilm(half_lit, {0.0, 0.8, 1.0, 10.0}, picture, 2, film, [&](std::size_t done) { told = done; });
    film.finish();
    EXPECT_EQ(told, 9U);
    EXPECT_EQ(probed("-count_frames -show_entries stream=width,height,nb_read_frames", path,
                     folder.path() / "facts"),
              "98,64,9\n");
    // Sums of the pictures as they are shown: the same while nothing moves, but for what the encoder mends,
    // and another when the laser has come on.
    const std::string sums = "ffmpeg -v error -i '" + path.string() +
                             "' -vf scale=8:8 -f rawvideo -pix_fmt rgb24 -y '" +
                             (folder.path() / "raw").string() + "'";
    ASSERT_EQ(std::system(sums.c_str()), 0);
    const std::string raw = base::contentOf(folder.path() / "raw");
    ASSERT_EQ(raw.size(), 9U * 8 * 8 * 3);
    const auto apart = [&](std::size_t a, std::size_t b) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 192; ++i)
        sum += std::abs(static_cast<unsigned char>(raw[192 * a + i]) -
                        static_cast<unsigned char>(raw[192 * b + i]));
      return sum / 192.0;
    };
    EXPECT_GT(apart(2, 6), 2.0 * apart(1, 2) + 0.2);
  }
}

}  // namespace
}  // namespace kerfbench::scene
