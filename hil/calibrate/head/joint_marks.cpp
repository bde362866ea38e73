// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/joint_marks.h"

#include <utility>

#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::calibrate {
namespace {

/// All others need no work: lenses of a head that has none.
std::vector<Eigen::Index> movingColumns(const WhitenedRows& rows) {
  const Eigen::Array<bool, 1, kHeadColumns + 1> moves = (rows.array() != 0.0).colwise().any();
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < moves.size(); ++k) {
    if (moves[k]) columns.push_back(k);
  }
  return columns;
}

}  // namespace

JointMarks::JointMarks(std::vector<Eigen::Matrix2d> whitenings_1_mm, RowMatrix basis, Eigen::MatrixXd shared)
    : whitenings_1_mm_(std::move(whitenings_1_mm)), basis_(std::move(basis)), shared_(std::move(shared)) {
  const auto n = static_cast<Eigen::Index>(whitenings_1_mm_.size());
  weight_xx_.resize(n);
  weight_xy_.resize(n);
  weight_yy_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Matrix2d& w = whitenings_1_mm_[static_cast<std::size_t>(i)];
    weight_xx_[i] = w.col(0).squaredNorm();
    weight_xy_[i] = w.col(0).dot(w.col(1));
    weight_yy_[i] = w.col(1).squaredNorm();
  }
  if (shared_.cols() == 0) return;
  Eigen::MatrixXd normal = shared_.transpose() * shared_;
  normal.diagonal().array() += 1.0;
  shared_normal_.compute(normal);
  shared_basis_ = shared_normal_.matrixL().solve(byFunctions(shared_).transpose());
}

template <typename Rows>
Eigen::MatrixXd JointMarks::byFunctions(const Rows& rows) const {
  Rows x(basis_.rows(), rows.cols()), y(basis_.rows(), rows.cols());
  for (Eigen::Index i = 0; i < basis_.rows(); ++i) {
    const Eigen::Matrix2d& w = whitenings_1_mm_[static_cast<std::size_t>(i)];
    x.row(i) = w(0, 0) * rows.row(2 * i) + w(1, 0) * rows.row(2 * i + 1);
    y.row(i) = w(0, 1) * rows.row(2 * i) + w(1, 1) * rows.row(2 * i + 1);
  }
  Eigen::MatrixXd products(2 * functions(), rows.cols());
  products.topRows(functions()).noalias() = basis_.transpose() * x;
  products.bottomRows(functions()).noalias() = basis_.transpose() * y;
  return products;
}

void JointMarks::linearise(const WhitenedRows& rows, const HeadVector& home) {
  home_ = home;
  const std::vector<Eigen::Index> moving = movingColumns(rows);
  const RowMatrix moved = rows(Eigen::all, moving);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(moved.cols(), moved.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(moved.transpose());
  square_ = Eigen::MatrixXd::Zero(kHeadColumns + 1, kHeadColumns + 1);
  square_(moving, moving) = square;
  if (functions() > 0) {
    crossed_ = Eigen::MatrixXd::Zero(2 * functions(), kHeadColumns + 1);
    crossed_(Eigen::all, moving) = byFunctions(moved);
  }
  if (shared_.cols() == 0) return;
  shared_rows_.resize(shared_.cols(), rows.cols());
  for (Eigen::Index k = 0; k < shared_.cols();
       ++k)  // Few rows, for which this is faster than products of matrices.
    shared_rows_.row(k).noalias() = shared_.col(k).transpose() * rows;
  shared_normal_.matrixL().solveInPlace(shared_rows_);
  square_.selfadjointView<Eigen::Lower>().rankUpdate(shared_rows_.transpose(), -1.0);
  if (functions() > 0) crossed_.noalias() -= shared_basis_.transpose() * shared_rows_;
}

const Eigen::MatrixXd& JointMarks::surfaceSquare() const {
  const Eigen::Index m = functions();
  if (surface_square_.rows() == 2 * m) return surface_square_;
  surface_square_ = Eigen::MatrixXd::Zero(2 * m, 2 * m);
  const auto block = [&](const Eigen::VectorXd& weights) {
    Eigen::MatrixXd square(m, m);
    const RowMatrix weighted = weights.asDiagonal() * basis_;
    square.triangularView<Eigen::Lower>() = basis_.transpose() * weighted;
    return square;
  };
  surface_square_.topLeftCorner(m, m).triangularView<Eigen::Lower>() = block(weight_xx_);
  surface_square_.bottomLeftCorner(m, m) = block(weight_xy_).selfadjointView<Eigen::Lower>();
  surface_square_.bottomRightCorner(m, m).triangularView<Eigen::Lower>() = block(weight_yy_);
  if (shared_.cols() > 0)
    surface_square_.selfadjointView<Eigen::Lower>().rankUpdate(shared_basis_.transpose(), -1.0);
  return surface_square_;
}

Eigen::VectorXd JointMarks::surfaceDiagonal() const {
  Eigen::VectorXd diagonal(2 * functions());
  const RowMatrix squares = basis_.cwiseAbs2();
  diagonal << squares.transpose() * weight_xx_, squares.transpose() * weight_yy_;
  if (shared_.cols() > 0) diagonal -= shared_basis_.colwise().squaredNorm().transpose();
  return diagonal;
}

Eigen::MatrixXd JointMarks::sharedSlopes() const {
  Eigen::MatrixXd slopes(shared_.cols(), kHeadColumns + 2 * functions() + 1);
  if (shared_.cols() > 0)
    slopes << shared_rows_.leftCols<kHeadColumns>(), shared_basis_, shared_rows_.col(kHeadColumns);
  return slopes;
}

Eigen::MatrixXd JointMarks::sharedReach(const Eigen::MatrixXd& rows) const {
  if (shared_.cols() == 0) return Eigen::MatrixXd(0, rows.rows());
  return shared_normal_.matrixL().solve(rows.transpose());
}

}  // namespace kerfbench::calibrate
