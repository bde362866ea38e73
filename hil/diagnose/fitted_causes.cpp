// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/fitted_causes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "hil/diagnose/known_causes.h"
#include "hil/diagnose/lost_steps.h"
#include "hil/diagnose/stage_fit.h"

namespace kerfbench::diagnose {
namespace {

/// Gain in score from which a cause is one at all, and a second beside the first.
constexpr double kWorthOne = 6.0;
constexpr double kWorthTwo = 30.0;
/// Causes whose scores lie nearer are not told apart.
constexpr double kAlike = 6.0;
/// Pulses that come twice now and then must fit better by so much than others that get lost: whole steps hide
/// the difference.
constexpr double kLostRather = 100.0;
/// Rows farther off than so many medians of all are left out.
constexpr double kFarAway = 9.0;
/// Share of the path's limit that a cause must move some line by.
constexpr double kWorthOfLimit = 0.3;
/// The same of each of two, and of what begins at some time: it can be put at any, and so fits noise as well.
constexpr double kWorthOfTwo = 0.7;
/// Share of the deviation that a cause must explain by itself, if it is named alone.
constexpr double kWorthOfShare = 0.005;
/// Relative standard uncertainty of sizes by what the signatures leave out: terms of the second order.
constexpr double kModel = 0.005;
constexpr double kGrossModel = 0.015;
/// Deviations from here on leave more of the second order than a second cause would: one is looked for.
constexpr double kGross_mm = 0.6;
/// So many of those that fit best are tried for one that moves anything by enough.
constexpr std::size_t kTried = 4;
constexpr std::size_t kFewest = 12;
/// So many of the best are tried together with one that begins at some time.
constexpr std::size_t kTimedWith = 8;

/// A place at which the cut deviates from the drawing.
struct Target {
  Row row;
  double away_mm{};
};

std::vector<Target> targetsOf(const Evidence& evidence) {
  std::vector<Target> targets;
  for (const LineReading& line : evidence.lines) {
    const double away_mm = std::isfinite(line.cut_mm) ? line.cut_mm : line.asked_mm;
    if (!std::isfinite(away_mm)) continue;
    Row row;
    row.along = line.normal;
    row.p_S_mm = line.p_S_mm;
    row.head = line.head;
    if (!row.head.known()) continue;
    row.sheet = line.sheet;
    row.table_mm = line.table_mm;
    row.unit = line.unit;
    targets.push_back({row, away_mm});
  }
  return targets;
}

class Ranker {
 public:
  explicit Ranker(const Evidence& evidence)
      : evidence_(evidence), targets_(targetsOf(evidence)), known_(knownCauses(evidence)) {
    std::vector<Row> rows = rowsOf(evidence);
    std::vector<Signature> signatures = signaturesOf(evidence);
    for (LostSteps& lost : lostSteps(evidence, rows)) {
      signatures.push_back(lost.signature);
      known_.push_back(std::move(lost.cause));
    }
    std::ranges::move(leakingPulses(evidence), std::back_inserter(known_));
    fit_.emplace(rows, signatures);
    widen(rows);
    fit_.emplace(std::move(rows), std::move(signatures));
    std::erase_if(known_, [&](const KnownCause& cause) { return !applies(cause); });
    none_ = fit_->fit({}).chi_square;
    penalty_ = std::log(static_cast<double>(std::max(kFewest, targets_.size())));
  }

  Fitted rank() {
    Fitted fitted;
    stages(fitted);
    double square = 0.0;
    for (const Target& t : targets_) square += t.away_mm * t.away_mm;
    if (!targets_.empty()) fitted.deviation_mm = std::sqrt(square / static_cast<double>(targets_.size()));
    if (targets_.size() < kFewest) return fitted;
    fitted_mm_ = fitted.deviation_mm;
    std::vector<Candidate> singles;
    for (const KnownCause& cause : known_)
      singles.push_back({{&cause}, scoreOf(cause.hypothesis) - unlikely(cause)});
    std::ranges::stable_sort(singles, std::greater<>(), &Candidate::score);
    if (singles.empty() || singles.front().score < kWorthOne) return fitted;
    Candidate chosen;
    for (std::size_t i = 0; i < std::min(kTried, singles.size()) && fitted.causes.empty(); ++i) {
      if (singles[i].score < kWorthOne) break;
      chosen = singles[i];
      fitted.causes = toldAll(chosen);
    }
    if (!(fitted.deviation_mm < kGross_mm)) return fitted;
    // Where two work against each other, neither explains anything alone.
    const std::optional<Candidate> two = bestPair(singles);
    if (!two || two->score < std::max(chosen.score, singles.front().score) + kWorthTwo) return fitted;
    if (std::vector<Cause> pair = toldAll(*two); pair.size() == 2) fitted.causes = std::move(pair);
    std::ranges::stable_sort(fitted.causes, std::greater<>(), &Cause::share);
    return fitted;
  }

 private:
  struct Candidate {
    std::vector<const KnownCause*> causes;
    double score{};
  };

  /// Pulses of one sense that come twice now and then look like those of the other that get lost, which they
  /// do more often.
  [[nodiscard]] double unlikely(const KnownCause& cause) const {
    if (cause.key != kPulsesLost || isTimed(cause)) return 0.0;
    const auto k = static_cast<Eigen::Index>(fit_->indexOf(cause.size_of.front()));
    return cause.factor * fit_->fit(cause.hypothesis).size(k) < 0.0 ? kLostRather : 0.0;
  }

  [[nodiscard]] bool applies(const KnownCause& cause) const {
    return std::ranges::all_of(cause.size_of, [&](const std::string& key) { return fit_->has(key); });
  }

  /// Makes the rows of each stage as uncertain as what all causes together leave of them shows, and takes out
  /// those that lie far from all others: a normal that met the way at another place.
  void widen(std::vector<Row>& rows) const {
    const std::vector<double> left = fit_->left(fit_->fit(all()));
    std::vector<bool> is_far(rows.size(), false);
    for (const Stage stage : {Stage::kProgram, Stage::kController, Stage::kMachine}) {
      std::vector<double> sizes;
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].stage == stage) sizes.push_back(std::abs(left[i]));
      if (sizes.empty()) continue;
      const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
      std::ranges::nth_element(sizes, middle);
      const double farthest = kFarAway * std::max(1.0, *middle);
      double square = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].stage != stage) continue;
        is_far[i] = std::abs(left[i]) > farthest;
        if (is_far[i]) continue;
        square += left[i] * left[i];
        ++count;
      }
      const double factor =
          std::sqrt(std::max(1.0, square / static_cast<double>(std::max<std::size_t>(1, count))));
      for (Row& row : rows)
        if (row.stage == stage) row.sigma_mm *= factor;
    }
    std::size_t i = 0;
    std::erase_if(rows, [&](const Row&) { return is_far[i++]; });
  }

  /// All but those that begin at some time, which would fit anything together.
  [[nodiscard]] Hypothesis all() const {
    Hypothesis everything{"all", {}};
    for (const Signature& signature : fit_->signatures())
      if (signature.key.find('@') == std::string::npos) everything.free.push_back(signature.key);
    return everything;
  }

  [[nodiscard]] double scoreOf(const Hypothesis& hypothesis) const {
    const Fit fit = fit_->fit(hypothesis);
    const bool has_time = std::ranges::any_of(
        hypothesis.free, [](const std::string& key) { return key.find('@') != std::string::npos; });
    return none_ - fit.chi_square - penalty_ * (fit.parameters + (has_time ? 1 : 0));
  }

  static bool isTimed(const KnownCause& cause) {
    return cause.size_of.front().find('@') != std::string::npos;
  }

  /// Tries all pairs of causes that are there all the time, and those that begin at some time with the best
  /// of these.
  [[nodiscard]] std::optional<Candidate> bestPair(const std::vector<Candidate>& singles) const {
    std::vector<const KnownCause*> steady, timed;
    for (const Candidate& single : singles)
      (isTimed(*single.causes[0]) ? timed : steady).push_back(single.causes[0]);
    std::optional<Candidate> best;
    const auto hold = [&](const KnownCause* a, const KnownCause* b) {
      if (shared(*a, *b)) return;
      const double score = scoreOf(both(a->hypothesis, b->hypothesis));
      if (!best || score > best->score) best = Candidate{{a, b}, score};
    };
    for (std::size_t i = 0; i < steady.size(); ++i)
      for (std::size_t k = i + 1; k < steady.size(); ++k) hold(steady[i], steady[k]);
    for (std::size_t i = 0; i < std::min(kTimedWith, steady.size()); ++i)
      for (const KnownCause* cause : timed) hold(steady[i], cause);
    if (!timed.empty())
      for (std::size_t k = 1; k < timed.size(); ++k) hold(timed[0], timed[k]);
    return best;
  }

  /// Two ways to say the same: pairs of them are none.
  static bool shared(const KnownCause& a, const KnownCause& b) {
    return std::ranges::any_of(a.size_of,
                               [&](const std::string& key) {
                                 return std::ranges::find(b.size_of, key) != b.size_of.end() ||
                                        std::ranges::find(b.hypothesis.free, key) != b.hypothesis.free.end();
                               }) ||
           (a.key == b.key);
  }

  /// The hypothesis of a candidate with sizes to be found in place of known ones.
  [[nodiscard]] static Hypothesis freed(const Candidate& candidate) {
    Hypothesis hypothesis;
    for (const KnownCause* cause : candidate.causes) {
      for (const std::string& key : cause->hypothesis.free) hypothesis.free.push_back(key);
      for (const std::string& key : cause->size_of)
        if (std::ranges::find(hypothesis.free, key) == hypothesis.free.end()) hypothesis.free.push_back(key);
    }
    return hypothesis;
  }

  /// What a cause explains of deviations, of lines or of spots.
  struct Explained {
    double before{}, after{}, most_mm{};
    std::size_t count{};
    [[nodiscard]] double share() const { return before > 0.0 ? std::max(0.0, 1.0 - after / before) : 0.0; }
    void take(double away_mm, double moved_mm) {
      before += away_mm * away_mm;
      after += (away_mm - moved_mm) * (away_mm - moved_mm);
      most_mm = std::max(most_mm, std::abs(moved_mm));
      ++count;
    }
  };

  [[nodiscard]] double movedBy(const KnownCause& cause, const Eigen::VectorXd& sizes, const Row& row) const {
    std::set<std::string> keys(cause.size_of.begin(), cause.size_of.end());
    keys.insert(cause.hypothesis.free.begin(), cause.hypothesis.free.end());
    double moved_mm = 0.0;
    for (const std::string& key : keys) {
      const std::size_t k = fit_->indexOf(key);
      if (k >= fit_->signatures().size()) continue;
      moved_mm +=
          sizes(static_cast<Eigen::Index>(k)) * fit_->signatures()[k].displacement_mm(row).dot(row.along);
    }
    return moved_mm;
  }

  /// Explains lines; spots where the cause moves no line aside, but the beam along them.
  [[nodiscard]] Explained explainedBy(const KnownCause& cause, const Eigen::VectorXd& sizes) const {
    Explained lines;
    for (const Target& target : targets_) lines.take(target.away_mm, movedBy(cause, sizes, target.row));
    const std::size_t k = fit_->indexOf(cause.size_of.front());
    if (lines.most_mm >= kWorthOfLimit * evidence_.limit_mm || fit_->signatures()[k].stage != Stage::kMachine)
      return lines;
    return explainedOfSpots(cause, sizes);
  }

  [[nodiscard]] Explained explainedOfSpots(const KnownCause& cause, const Eigen::VectorXd& sizes) const {
    Explained spots;
    for (const Row& row : fit_->all())
      if (row.of_spot) spots.take(row.y_mm, movedBy(cause, sizes, row));
    return spots;
  }

  /// True for a cause that leaves lines as far off as they were, and spots as well.
  [[nodiscard]] bool explainsNothing(const KnownCause& known, const Eigen::VectorXd& sizes,
                                     double share) const {
    if (share >= kWorthOfShare) return false;
    const bool is_of_machine =
        fit_->signatures()[fit_->indexOf(known.size_of.front())].stage == Stage::kMachine;
    return !is_of_machine || explainedOfSpots(known, sizes).share() < kWorthOfShare;
  }

  /// All causes of a candidate that move lines, or the spot along them, by enough.
  [[nodiscard]] std::vector<Cause> toldAll(const Candidate& chosen) const {
    std::vector<Cause> causes;
    for (const KnownCause* cause : chosen.causes) causes.push_back(told(*cause, chosen));
    std::erase_if(causes, [](const Cause& c) { return c.key.empty(); });
    return causes;
  }

  /// The cause with its size; without a key if it moves nothing by enough.
  [[nodiscard]] Cause told(const KnownCause& known, const Candidate& chosen) const {
    const Fit fit = fit_->fit(freed(chosen));
    Cause cause;
    std::vector<double> sizes;
    double square = 0.0, variance = 0.0;
    for (const std::string& key : known.size_of) {
      const auto k = static_cast<Eigen::Index>(fit_->indexOf(key));
      sizes.push_back(known.factor * fit.size(k));
      square += sizes.back() * sizes.back();
      // What the machine has of it within its tolerances is part of what is measured.
      const double usual = fit_->signatures()[static_cast<std::size_t>(k)].usual;
      variance = std::max(variance, known.factor * known.factor * (fit.covariance(k, k) + usual * usual));
    }
    const double gross = fitted_mm_ > kGross_mm ? kGrossModel : kModel;
    variance += square * std::max(known.model, gross) * std::max(known.model, gross);
    cause.size = {sizes.size() == 1 ? sizes[0] : std::sqrt(square), 2.0 * std::sqrt(variance), known.unit};
    const Explained explained = explainedBy(known, fit.size);
    cause.share = explained.share();
    cause.left_mm =
        std::sqrt(explained.after / static_cast<double>(std::max<std::size_t>(1, explained.count)));
    cause.score = chosen.score;
    const bool is_alone = chosen.causes.size() == 1;
    const double worth = is_alone && !isTimed(known) ? kWorthOfLimit : kWorthOfTwo;
    if (explained.most_mm < worth * evidence_.limit_mm || (is_alone && cause.share < kWorthOfShare))
      return {};
    if (known.only_positive && !(cause.size.value > 0.0)) return {};
    cause.key = known.key == kPulsesLost && cause.size.value < 0.0 ? kPulsesDoubled : known.key;
    if (isTimed(known) || known.key == kPulsesLost) cause.size.value = std::abs(cause.size.value);
    cause.instead = alternatives(known, chosen);
    cause.sentence =
        fmt::format("{}: explains {:.0f} % of the deviation, {:.3f} mm RMS are left; {}.",
                    known.what(sizes, cause.size.U), 100.0 * cause.share, cause.left_mm, known.advice(sizes));
    return cause;
  }

  /// What would explain it as well in place of one of the chosen.
  [[nodiscard]] std::vector<std::string> alternatives(const KnownCause& known,
                                                      const Candidate& chosen) const {
    std::vector<std::string> keys;
    for (const KnownCause& other : known_) {
      if (other.key == known.key || std::ranges::find(keys, other.key) != keys.end()) continue;
      Hypothesis hypothesis = other.hypothesis;
      bool is_chosen = false;
      for (const KnownCause* cause : chosen.causes) {
        is_chosen |= cause == &other;
        if (cause != &known) hypothesis = both(hypothesis, cause->hypothesis);
      }
      if (!is_chosen && scoreOf(hypothesis) > chosen.score - kAlike) keys.push_back(other.key);
    }
    return keys;
  }

  void stages(Fitted& fitted) const {
    std::vector<double> counts(3, 0.0);
    for (const Row& row : fit_->all()) {
      if (row.of_spot) continue;
      const auto stage = static_cast<std::size_t>(row.stage);
      fitted.stage_mm2[stage] += row.y_mm * row.y_mm;
      counts[stage] += 1.0;
    }
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] > 0.0) fitted.stage_mm2[i] /= counts[i];
  }

  const Evidence& evidence_;
  std::vector<Target> targets_;
  std::vector<KnownCause> known_;
  std::optional<StageFit> fit_;
  double none_{};
  double fitted_mm_{};
  double penalty_{};
};

}  // namespace

Fitted fittedCauses(const Evidence& evidence) { return Ranker(evidence).rank(); }

}  // namespace kerfbench::diagnose
