// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "hil/fold/fold_scenario.h"
#include "hil/fold/judge/fold_cameras.h"
#include "hil/fold/judge/fold_judge.h"
#include "twin/five_axis/folded_cut.h"

namespace kerfbench::fold {

/// The cameras of the model: survey cameras before the standing blank, the kerf camera over each face, which
/// was cut off and laid on its table.
class TwinFoldCameras final : public FoldCameras {
 public:
  /// `scenario` and `cut` must outlive this. `threads` changes the time it takes, never the pictures.
  TwinFoldCameras(const FoldScenario& scenario, const twin::FoldedCut& cut, int threads);
  std::vector<GrayImage> surveyPictures() override;
  std::unique_ptr<camera::TileSource> kerfTiles(std::size_t face) override;

 private:
  const FoldScenario& scenario_;
  const twin::FoldedCut& cut_;
  int threads_;
};

/// Cuts the blank on the model.
twin::FoldedCut cutOnTwin(const FoldScenario& scenario);

/// What the bench is told of its instruments. A survey camera's calibration is that of the model with an
/// error that is sampled from its certificate; the bench gets the certificate as error modes.
FoldInstruments instrumentsOf(const FoldScenario& scenario, int threads);

}  // namespace kerfbench::fold
