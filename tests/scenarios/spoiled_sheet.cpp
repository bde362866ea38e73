// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/spoiled_sheet.h"

#include <cmath>

#include <Eigen/Geometry>

#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/camera/kerf_tile.h"
#include "hil/camera/tile_folder.h"
#include "hil/head_service/measured_sheet.h"
#include "twin/base/image.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

constexpr double kBeside = 2.1;  // Reach of an erased area in halves of the mark: board, and no other mark.

cv::Mat matOf(GrayImage& image) { return {image.height, image.width, CV_8UC1, image.pixels.data()}; }

cv::Rect shownIn(const cv::Mat& picture, const cv::Rect& box) {
  return box & cv::Rect(0, 0, picture.cols, picture.rows);
}

/// Tiles that are handed out as they are.
class Tiles final : public camera::TileSource {
 public:
  explicit Tiles(const std::vector<camera::KerfTile>& tiles) : tiles_(tiles) {}
  std::vector<camera::KerfTile> nextBatch(std::size_t max) override {
    std::vector<camera::KerfTile> batch;
    for (; next_ < tiles_.size() && batch.size() < max; ++next_) batch.push_back(tiles_[next_]);
    return batch;
  }

 private:
  const std::vector<camera::KerfTile>& tiles_;
  std::size_t next_{0};
};

}  // namespace

SpoiledSheet::SpoiledSheet(const fs::path& sheet, const head_service::HeadSetup& setup)
    : setup_(setup), job_(head_service::readJobOf(setup, sheet / "marks.yaml")) {
  camera::TileFolder folder = head_service::openPictures(setup, sheet / "pictures");
  tiles_ = folder.nextBatch(folder.size());
  Tiles source(tiles_);
  calibrate::FieldSearchOptions search;
  search.size_mm = job_.size_mm;
  search.beam_radius_mm = setup.beam_radius_mm;
  const calibrate::FieldPictures found = calibrate::findFieldMarks(source, setup.camera, job_.print, search);
  pose_ = found.pose;
  for (const calibrate::FieldMark& mark : found.marks) marks_S_mm_.emplace(mark.number, mark.p_S_mm);
}

std::vector<int> SpoiledSheet::numbers() const {
  std::vector<int> numbers;
  for (const auto& [number, p_S_mm] : marks_S_mm_) numbers.push_back(number);
  return numbers;
}

Vector2d SpoiledSheet::p_T_mm(const Vector2d& p_S_mm) const {
  return Eigen::Rotation2Dd(pose_.angle_rad) * p_S_mm + pose_.p_TS_mm;
}

void SpoiledSheet::edit(const Vector2d& p_S_mm, double half_mm, const Edit& how) {
  const int half_px = static_cast<int>(std::ceil(half_mm / setup_.camera.pitchMm()));
  for (camera::KerfTile& tile : tiles_) {
    const Vector2d pixel = setup_.camera.pixelFromPlane(p_T_mm(p_S_mm) - tile.p_TV_mm);
    const cv::Point middle(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y())));
    const cv::Rect box(middle.x - half_px, middle.y - half_px, 2 * half_px + 1, 2 * half_px + 1);
    cv::Mat picture = matOf(tile.image);
    if (shownIn(picture, box).empty()) continue;
    how(picture, picture.clone(), box);
  }
}

void SpoiledSheet::erase(const Vector2d& p_S_mm, double half_mm) {
  edit(p_S_mm, half_mm, [](cv::Mat& picture, const cv::Mat& before, const cv::Rect& box) {
    const int beside = static_cast<int>(kBeside * 0.5 * box.width);
    const cv::Rect shown = shownIn(picture, box);
    for (const cv::Point& by : {cv::Point(beside, beside), cv::Point(-beside, beside),
                                cv::Point(beside, -beside), cv::Point(-beside, -beside)}) {
      const cv::Rect board(shown.tl() + by, shown.size());
      if (shownIn(picture, board) != board) continue;
      before(board).copyTo(picture(shown));
      return;
    }
  });
}

void SpoiledSheet::erase(int number) {
  erase(marks_S_mm_.at(number), 0.5 * calibrate::kMarkReach * job_.size_mm + 0.5);
}

void SpoiledSheet::paste(int number, const Vector2d& by_mm, const std::vector<camera::KerfTile>& from) {
  const int half_px = static_cast<int>(
      std::ceil((0.5 * calibrate::kMarkReach * job_.size_mm + 0.3) / setup_.camera.pitchMm()));
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    camera::KerfTile source = from.at(t);
    const cv::Mat before = matOf(source.image);
    cv::Mat picture = matOf(tiles_[t].image);
    const Vector2d p_V_mm = p_T_mm(marks_S_mm_.at(number)) - source.p_TV_mm;
    const Vector2d pixel = setup_.camera.pixelFromPlane(p_V_mm);
    const Vector2d by_px = setup_.camera.pixelFromPlane(p_V_mm + by_mm) - pixel;
    const cv::Point shift(static_cast<int>(std::lround(by_px.x())), static_cast<int>(std::lround(by_px.y())));
    const cv::Rect box(static_cast<int>(pixel.x()) - half_px, static_cast<int>(pixel.y()) - half_px,
                       2 * half_px, 2 * half_px);
    const cv::Rect to = shownIn(picture, shownIn(picture, box) + shift);
    if (to.empty()) continue;
    cv::Mat part = picture(to);
    // The brighter picture wins: light comes through cuts.
    cv::max(part, before(to - shift), part);
  }
}

void SpoiledSheet::again(int number, const Vector2d& by_mm) { paste(number, by_mm, tiles_); }

void SpoiledSheet::move(int number, const Vector2d& by_mm) {
  const std::vector<camera::KerfTile> before = tiles_;
  erase(number);
  paste(number, by_mm, before);
}

void SpoiledSheet::erasePrint() {
  for (const RegistrationMark& mark : job_.print) erase(mark.p_SM_mm, 0.5 * mark.diameter_mm + 1.0);
}

void SpoiledSheet::change(std::size_t tile, const std::function<void(cv::Mat&)>& how) {
  cv::Mat picture = matOf(tiles_.at(tile).image);
  how(picture);
}

void SpoiledSheet::changeAll(const std::function<void(cv::Mat&)>& how) {
  for (std::size_t t = 0; t < tiles_.size(); ++t) change(t, how);
}

void SpoiledSheet::write(const fs::path& folder) const {
  Tiles source(tiles_);
  camera::writeTiles(source, folder);
}

}  // namespace kerfbench::test
