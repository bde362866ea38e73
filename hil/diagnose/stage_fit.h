// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "hil/diagnose/signature.h"

namespace kerfbench::diagnose {

/// What is taken to be wrong: signatures of a size that is to be found, and others of a known one.
struct Hypothesis {
  std::string key;
  std::vector<std::string> free;
  std::vector<std::pair<std::string, double>> fixed{};

  [[nodiscard]] bool isEmpty() const { return free.empty() && fixed.empty(); }
};

/// Both at once.
Hypothesis both(const Hypothesis& a, const Hypothesis& b);

/// A hypothesis held against the rows by weighted least squares. What a machine may have within its
/// tolerances is fitted along, held to them as to a measurement (Bayesian linear regression with normal
/// priors), so that a size is as uncertain as the tolerances make it.
struct Fit {
  double chi_square{};
  int parameters{};      ///< Sizes that were found.
  Eigen::VectorXd size;  ///< Sizes of all signatures in their order; 0 where one has no part.
  Eigen::MatrixXd covariance;
};

class StageFit {
 public:
  StageFit(std::vector<Row> rows, std::vector<Signature> signatures);

  [[nodiscard]] const std::vector<Signature>& signatures() const { return signatures_; }
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] const std::vector<Row>& all() const { return rows_; }
  [[nodiscard]] bool has(const std::string& key) const { return indexOf(key) < signatures_.size(); }
  [[nodiscard]] std::size_t indexOf(const std::string& key) const;  ///< signatures().size(): there is none.

  /// What a fit leaves of each row, over its sigma.
  [[nodiscard]] std::vector<double> left(const Fit& fit) const;

  /// Signatures of the hypothesis that there are none of are left out.
  [[nodiscard]] Fit fit(const Hypothesis& hypothesis) const;

 private:
  std::vector<Row> rows_;
  std::vector<Signature> signatures_;
  Eigen::MatrixXd normal_;   ///< Weighted normal matrix of all signatures.
  Eigen::VectorXd against_;  ///< The same of signatures and rows.
  double square_{};          ///< Weighted sum of squares of the rows.
};

}  // namespace kerfbench::diagnose
