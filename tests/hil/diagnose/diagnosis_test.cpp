// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/diagnose/evidence_json.h"
#include "hil/diagnose/signature.h"
#include "tests/hil/diagnose/synthetic_evidence.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace kerfbench::diagnose {
namespace {

using Eigen::Vector2d;
using test::SyntheticEvidence;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A cause that moves lines: what it does to the evidence, and the size that must be found.
struct Seeded {
  const char* key;
  bool moves;  ///< The sheet does.
  bool gantry;
  std::function<void(SyntheticEvidence&)> put;
  double size;
};

std::ostream& operator<<(std::ostream& out, const Seeded& seeded) { return out << seeded.key; }

SyntheticEvidence::Moves along(std::function<Vector2d(const HeadState&, const SheetState&)> by) { return by; }

const std::vector<Seeded>& seededCauses() {
  static const std::vector<Seeded> kSeeded{
      {"program_offset", true, false,
       [](auto& e) { e.program([](const Vector2d&) { return Vector2d(0.06, -0.03); }); }, 0.0671},
      {"program_rotation", true, false,
       [](auto& e) {
         e.program([](const Vector2d& p) { return Vector2d(-0.0025 * p.y(), 0.0025 * p.x()); });
       },
       2.5},
      {"program_scale", false, false,
       [](auto& e) { e.program([](const Vector2d& p) { return Vector2d(-0.0024 * p); }); }, -0.24},
      {"program_scale_x", false, false,
       [](auto& e) { e.program([](const Vector2d& p) { return Vector2d(0.0024 * p.x(), 0.0); }); }, 0.24},
      {"program_scale_y", false, false,
       [](auto& e) { e.program([](const Vector2d& p) { return Vector2d(0.0, 0.004 * p.y()); }); }, 0.4},
      {"program_shear", false, true,
       [](auto& e) { e.program([](const Vector2d& p) { return Vector2d(0.004 * p.y(), 0.0); }); }, 4.0},
      {"step_scale", false, false,
       [](auto& e) {
         e.controller(along([](const auto& h, const auto&) { return Vector2d(0.0025 * h.p_mm); }));
       },
       0.25},
      {"step_scale_y", false, true,
       [](auto& e) {
         e.controller(along([](const auto& h, const auto&) { return Vector2d(0.0, 0.005 * h.p_mm.y()); }));
       },
       0.5},
      {"sheet_reference", true, false,
       [](auto& e) { e.controller(along([](const auto&, const auto&) { return Vector2d(-0.09, 0.0); })); },
       -0.09},
      {"encoder_scale", true, false,
       [](auto& e) {
         e.controller(
             along([](const auto&, const auto& s) { return Vector2d(0.0004 * s.since_mark_mm, 0.0); }));
       },
       0.04},
      {"latency", true, true,
       [](auto& e) {
         e.controller(
             along([](const auto&, const auto& s) { return Vector2d(-0.0025 * s.speed_mm_s, 0.0); }));
       },
       2.5},
      {"mean_speed", true, false,
       [](auto& e) {
         e.controller(along([](const auto&, const auto& s) { return Vector2d(-s.off_plan_mm, 0.0); }));
       },
       100.0},
      {"belt_ignored", true, false,
       [](auto& e) {
         e.controller(
             along([](const auto&, const auto& s) { return Vector2d(150.0 - s.since_mark_mm, 0.0); }));
       },
       100.0},
      {"pincushion_missing", false, false,
       [](auto& e) {
         const MachineFacts machine = e.evidence().machine;
         e.controller(
             along([machine](const auto& h, const auto&) { return withoutPincushion_mm(machine, h.p_mm); }));
       },
       100.0},
      {"head_offset", false, false,
       [](auto& e) { e.machine(along([](const auto&, const auto&) { return Vector2d(0.03, 0.12); })); },
       0.1237},
      {"head_rotation", false, false,
       [](auto& e) {
         e.machine(along(
             [](const auto& h, const auto&) { return Vector2d(-0.003 * h.p_mm.y(), 0.003 * h.p_mm.x()); }));
       },
       3.0},
      {"head_scale", false, false,
       [](auto& e) { e.machine(along([](const auto& h, const auto&) { return Vector2d(0.003 * h.p_mm); })); },
       0.3},
      {"head_shear", false, true,
       [](auto& e) {
         e.machine(along([](const auto& h, const auto&) { return Vector2d(-0.004 * h.p_mm.y(), 0.0); }));
       },
       4.0},
      {"axes_lag", true, false,
       [](auto& e) {
         e.machine(along([](const auto& h, const auto&) { return Vector2d(-0.0015 * h.v_mm_s); }));
       },
       1.5},
      {"backlash_x", false, true,
       [](auto& e) {
         e.machine(along([](const auto& h, const auto&) { return Vector2d(-0.06 * h.flank.x(), 0.0); }));
       },
       0.12},
      {"pulses_lost", false, false,
       [](auto& e) {
         e.controller(
             along([](const auto& h, const auto&) { return Vector2d(0.0, h.time_s > 5.3 ? 0.1 : 0.0); }));
       },
       8.0},
      {"axis_slipped", false, true,
       [](auto& e) {
         e.machine(
             along([](const auto& h, const auto&) { return Vector2d(h.time_s > 5.3 ? 0.1 : 0.0, 0.0); }));
       },
       0.1},
  };
  return kSeeded;
}

class CausesOfLines : public testing::TestWithParam<Seeded> {};

TEST_P(CausesOfLines, AreNamedWithTheirSize) {
  const Seeded& seeded = GetParam();
  SyntheticEvidence made(seeded.moves, seeded.gantry);
  seeded.put(made);
  const Diagnosis diagnosis = diagnose(made.evidence());
  ASSERT_FALSE(diagnosis.causes.empty()) << diagnosis.sentence;
  const Cause& first = diagnosis.causes.front();
  // What jumps at a time is told from its direction: the sign of a turn may make it doubled.
  EXPECT_EQ(first.key == "pulses_doubled" ? "pulses_lost" : first.key, seeded.key) << first.sentence;
  EXPECT_NEAR(std::abs(first.size.value), std::abs(seeded.size), first.size.U) << first.sentence;
  EXPECT_LT(first.size.U, 0.3 * std::abs(seeded.size)) << first.sentence;
  EXPECT_GT(first.share, 0.8) << first.sentence;
  EXPECT_EQ(diagnosis.causes.size(), 1U) << diagnosis.causes.back().sentence;
}

INSTANTIATE_TEST_SUITE_P(All, CausesOfLines, testing::ValuesIn(seededCauses()),
                         [](const auto& info) { return std::string(info.param.key); });

TEST(Diagnosis, SaysNothingOfARunThatHasPassed) {
  SyntheticEvidence made;
  made.program([](const Vector2d&) { return Vector2d(0.06, 0.0); });
  made.evidence().passed = true;
  EXPECT_TRUE(diagnose(made.evidence()).causes.empty());
  EXPECT_EQ(diagnose(made.evidence()).sentence, "");
}

TEST(Diagnosis, InventsNothingWhereAMachineKeepsItsTolerances) {
  SyntheticEvidence made;
  made.machine(along([](const auto& h, const auto&) {
    return Vector2d(0.012 - 3e-5 * h.p_mm.y(), -0.01 + 3e-5 * h.p_mm.x());
  }));
  EXPECT_TRUE(diagnose(made.evidence()).causes.empty());
}

TEST(Diagnosis, SaysWhereADeviationArisesThatNoCauseExplains) {
  SyntheticEvidence made(false);
  // A wave along x that no machine makes.
  made.machine(
      along([](const auto& h, const auto&) { return Vector2d(0.0, 0.06 * std::sin(2.0 * h.p_mm.x())); }));
  const Diagnosis diagnosis = diagnose(made.evidence());
  EXPECT_TRUE(diagnosis.causes.empty()) << diagnosis.sentence;
  EXPECT_THAT(diagnosis.sentence, HasSubstr("None of the known causes explains this"));
  EXPECT_THAT(diagnosis.sentence, HasSubstr("0 % arise between drawing and program"));
  EXPECT_THAT(diagnosis.arises, HasSubstr("between pulses and beam"));
}

TEST(Diagnosis, SaysNotWhereASmallDeviationArises) {
  SyntheticEvidence made(false);
  made.machine(
      along([](const auto& h, const auto&) { return Vector2d(0.0, 0.01 * std::sin(2.0 * h.p_mm.x())); }));
  const Diagnosis diagnosis = diagnose(made.evidence());
  EXPECT_TRUE(diagnosis.causes.empty()) << diagnosis.sentence;
  EXPECT_EQ(diagnosis.arises, "");
}

TEST(Diagnosis, NamesTwoCausesAtOnce) {
  SyntheticEvidence made;
  made.program([](const Vector2d& p) { return Vector2d(-0.003 * p.y(), 0.003 * p.x()); });
  made.controller(along([](const auto&, const auto& s) { return Vector2d(0.0005 * s.since_mark_mm, 0.0); }));
  const Diagnosis diagnosis = diagnose(made.evidence());
  std::vector<std::string> keys;
  for (const Cause& cause : diagnosis.causes) keys.push_back(cause.key);
  EXPECT_THAT(keys, testing::UnorderedElementsAre("program_rotation", "encoder_scale"));
}

TEST(Diagnosis, SaysWhatARunCannotTellApart) {
  SyntheticEvidence made;
  // At one speed a late belt and a print mark elsewhere are the same.
  for (auto& line : made.evidence().lines) line.sheet.speed_mm_s = 30.0;
  made.controller(along([](const auto&, const auto& s) { return Vector2d(-0.002 * s.speed_mm_s, 0.0); }));
  const Diagnosis diagnosis = diagnose(made.evidence());
  ASSERT_FALSE(diagnosis.causes.empty());
  const Cause& first = diagnosis.causes.front();
  std::vector<std::string> keys = first.instead;
  keys.push_back(first.key);
  EXPECT_THAT(keys, testing::IsSupersetOf({"latency", "sheet_reference"}));
  EXPECT_THAT(first.sentence, HasSubstr("cannot tell"));
}

TEST(Diagnosis, PutsWhatPinsShowBeforeWhatFits) {
  SyntheticEvidence made(false, true);
  made.machine(along([](const auto& h, const auto&) { return Vector2d(h.time_s > 5.3 ? 0.1 : 0.0, 0.0); }));
  DriveReading drive;
  drive.axis = "gantry_x";
  drive.setup_violations = 12;
  drive.least_setup_s = 1e-6;
  drive.setup_s = 5e-6;
  made.evidence().drives.push_back(drive);
  const Diagnosis diagnosis = diagnose(made.evidence());
  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_EQ(diagnosis.causes[0].key, "dir_timing");
  EXPECT_TRUE(diagnosis.causes[0].direct);
  EXPECT_NEAR(diagnosis.causes[0].size.value, 1.0, 1e-9);
  EXPECT_GT(diagnosis.causes[0].share, 0.5);
}

TEST(Diagnosis, CountsPulsesThatTheControllerBelievesToHaveMade) {
  SyntheticEvidence made(false, true);
  DriveReading drive;
  drive.axis = "gantry_y";
  drive.told = 1000;
  drive.seen = 993;
  made.evidence().drives.push_back(drive);
  const Diagnosis diagnosis = diagnose(made.evidence());
  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_EQ(diagnosis.causes[0].key, "pulses_lost");
  EXPECT_EQ(diagnosis.causes[0].size.value, 7.0);
}

TEST(Diagnosis, TellsALateGateAndAnEarlyOne) {
  for (const double late_s : {1.2e-3, -1.2e-3}) {
    SyntheticEvidence made(false);
    for (int i = 0; i < 8; ++i)
      made.evidence().gates.push_back({0, i, late_s + (i % 3 - 1) * 1e-4, 1e-5, 1.0});
    const Diagnosis diagnosis = diagnose(made.evidence());
    ASSERT_EQ(diagnosis.causes.size(), 1U);
    EXPECT_EQ(diagnosis.causes[0].key, late_s > 0.0 ? "gate_late" : "gate_early");
    EXPECT_NEAR(diagnosis.causes[0].size.value, 1.2, diagnosis.causes[0].size.U);
  }
}

TEST(Diagnosis, TellsPowerOfAnotherScale) {
  SyntheticEvidence made(false);
  for (int i = 0; i < 8; ++i) made.evidence().gates.push_back({0, i, 0.0, 0.0, 1.2 + 0.002 * (i % 3)});
  const Diagnosis diagnosis = diagnose(made.evidence());
  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_EQ(diagnosis.causes[0].key, "power_scale");
  EXPECT_NEAR(diagnosis.causes[0].size.value, 20.0, 1.0);
}

TEST(Diagnosis, TellsALoopThatRings) {
  SyntheticEvidence of;
  of.evidence().power_swing = PowerSwing{0.3, 0.02, 0.009};
  const Diagnosis diagnosis = diagnose(of.evidence());
  ASSERT_FALSE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.causes.front().key, "power_loop_rings");
  EXPECT_THAT(diagnosis.sentence, HasSubstr("in a period of 9.0 ms"));
}

TEST(Diagnosis, TellsABeamThatAStepperLost) {
  SyntheticEvidence of(false);
  Evidence& evidence = of.evidence();
  evidence.beam_unseen = 0.9;
  evidence.burnt_elsewhere = true;
  const auto isToldSo = [&] {
    const Diagnosis diagnosis = diagnose(evidence);
    return !diagnosis.causes.empty() && diagnosis.causes.front().key == "stepper_pulled_out";
  };
  EXPECT_FALSE(isToldSo()) << "a servo is no stepper";
  evidence.machine.full_step_pulses = {64.0, 64.0};
  EXPECT_TRUE(isToldSo());
  evidence.burnt_elsewhere = false;
  EXPECT_FALSE(isToldSo()) << "a laser that is dark burns nowhere";
  EXPECT_EQ(diagnose(evidence).causes.at(0).key, "beam_unseen");
  evidence.burnt_elsewhere = true;
  evidence.axes = "X and Y are swapped.";
  EXPECT_FALSE(isToldSo()) << "axes that are swapped lead the beam elsewhere as well";
}

TEST(Diagnosis, NamesNoCauseThatExplainsNothing) {
  // One line alone lies a millimetre aside, as no known cause does it.
  SyntheticEvidence of(false);
  for (LineReading& line : of.evidence().lines)
    if (line.entity == 6) line.cut_mm += (line.p_S_mm.y() > 0.0 ? 1.0 : -1.0);
  for (const Cause& cause : diagnose(of.evidence()).causes) EXPECT_GE(cause.share, 0.005) << cause.sentence;
}

TEST(Diagnosis, TellsWhoLeftAnEntityOut) {
  for (const bool in_program : {true, false}) {
    SyntheticEvidence made(false);
    for (const int entity : {0, 1, 2}) made.evidence().entities.push_back({0, entity, 1.0, 1.0, true, 1});
    made.evidence().entities.push_back({0, 5, 0.0, 0.0, in_program, in_program ? 1 : 0});
    const Diagnosis diagnosis = diagnose(made.evidence());
    ASSERT_EQ(diagnosis.causes.size(), 1U);
    EXPECT_EQ(diagnosis.causes[0].key, "entity_missing");
    EXPECT_THAT(diagnosis.causes[0].sentence,
                HasSubstr(in_program ? "the release left it out" : "the planner left it out"));
  }
}

TEST(Diagnosis, TellsACompensationOfTheKerf) {
  struct Kerf {
    const char* key;
    double program_mm, cut_mm;
  };
  for (const auto& [key, program_mm, cut_mm] :
       {Kerf{"kerf_uncompensated", 0.0, 0.05}, Kerf{"kerf_wrong_side", -0.05, -0.1},
        Kerf{"kerf_radius", 0.11, 0.06}}) {
    SyntheticEvidence made(false);
    made.evidence().edges_judged = true;
    made.evidence().kerf_radius_mm = 0.05;
    for (auto& line : made.evidence().lines) {
      line.program_mm = program_mm;
      line.cut_mm += cut_mm;
    }
    const Diagnosis diagnosis = diagnose(made.evidence());
    ASSERT_EQ(diagnosis.causes.size(), 1U) << key;
    EXPECT_EQ(diagnosis.causes[0].key, key);
    EXPECT_NEAR(std::abs(diagnosis.causes[0].size.value), std::abs(cut_mm), diagnosis.causes[0].size.U);
  }
}

TEST(Diagnosis, HasAKeyForEachOfItsCauses) {
  for (const Seeded& seeded : seededCauses()) EXPECT_THAT(causeKeys(), Contains(seeded.key));
  EXPECT_TRUE(std::ranges::is_sorted(causeKeys()));
}

TEST(EvidenceJson, KeepsWhatTheDiagnosisGoesBy) {
  SyntheticEvidence made;
  made.controller(along([](const auto&, const auto& s) { return Vector2d(0.0005 * s.since_mark_mm, 0.0); }));
  made.evidence().belt = BeltReading{1.0001, 1e-5, 120.0};
  made.evidence().power_swing = PowerSwing{0.3, 0.02, 0.009};
  made.evidence().beam_unseen = 0.25;
  made.evidence().drives.push_back({"galvo_x", 0.0129, 100, 1, 0, 0, 0, 1e-6, 5e-6, 2e-6, 5e-6, 1.5, 7, {}});
  const std::string text = evidenceJson(made.evidence());
  const Evidence read = evidenceFromJson(text);
  ASSERT_TRUE(read.power_swing);
  EXPECT_DOUBLE_EQ(read.power_swing->period_s, 0.009);
  EXPECT_DOUBLE_EQ(read.beam_unseen, 0.25);
  EXPECT_EQ(evidenceJson(read), text);
  EXPECT_EQ(diagnose(read).causes.at(0).key, diagnose(made.evidence()).causes.at(0).key);
  EXPECT_THROW(evidenceFromJson("{}"), std::runtime_error);
  EXPECT_THROW(evidenceFromJson("no JSON"), std::runtime_error);
}

}  // namespace
}  // namespace kerfbench::diagnose
