// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/child_check.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::doctor {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class ChildCheck : public testing::Test {
 protected:
  /// The child to start from, with something in it changed.
  [[nodiscard]] fs::path childWith(const std::string& old, const std::string& changed) const {
    std::string text = base::contentOf(base::fixture("children/script_child.py"));
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    const fs::path path = folder_.write("child.py", text.replace(at, old.size(), changed));
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }
  [[nodiscard]] std::vector<DoctorFinding> check(const fs::path& child) const {
    std::string script;
    for (int tick = 1000; tick < 300'000; tick += 1000)
      script += std::to_string(tick) + " 0 " + std::to_string(tick / 1000 % 2) + "\n";
    return checkChild({.child = child, .image = folder_.write("script.txt", script), .seconds = 0.02});
  }
  [[nodiscard]] static std::string troublesIn(const std::vector<DoctorFinding>& findings) {
    std::string text;
    for (const DoctorFinding& finding : findings)
      if (finding.grade != DoctorFinding::Grade::kGood) text += finding.text + "\n";
    return text;
  }
  base::TempFolder folder_;
};

TEST_F(ChildCheck, TheOneToStartFromIsGood) {
  const auto findings = check(base::fixture("children/script_child.py"));
  EXPECT_THAT(troublesIn(findings), IsEmpty());
  ASSERT_EQ(findings.size(), 6U);
  EXPECT_THAT(findings[0].text, HasSubstr("a tick is 1/16000000 s"));
  EXPECT_THAT(findings[1].text, HasSubstr("299 events in order"));
}

TEST_F(ChildCheck, TheFindingsAreJsonAsWell) {
  const auto json = nlohmann::json::parse(findingsJson(check(base::fixture("children/script_child.py"))));
  ASSERT_EQ(json.at("findings").size(), 6U);
  EXPECT_EQ(json.at("findings")[0].at("grade"), "good");
  EXPECT_THAT(json.at("findings")[1].at("text").get<std::string>(), HasSubstr("299 events in order"));
}

TEST_F(ChildCheck, TheAvrEmulatorIsGood) {
  const auto findings = checkChild({.child = KERFBENCH_AVR_CHILD,
                                    .image = fs::path(KERFBENCH_IMAGES) / "pulses-atmega2560.hex",
                                    .seconds = 0.05});
  EXPECT_THAT(troublesIn(findings), IsEmpty());
  EXPECT_EQ(findings.size(), 6U);
}

TEST_F(ChildCheck, EventsOutOfOrderAreNamed) {
  EXPECT_THAT(troublesIn(check(childWith("out.append(struct.pack(\"<QHHHH\", tick,",
                                         "out.append(struct.pack(\"<QHHHH\", until - tick % 8000,"))),
              HasSubstr("the ticks of its events do not ascend"));
}

TEST_F(ChildCheck, ARunThatCannotBeRepeatedIsNamed) {
  // The process number differs from run to run.
  const std::string troubles = troublesIn(check(childWith(
      "events = sorted((tuple(map(int, line.split())) for line in file if line.strip()), key=by_tick)",
      "import os; events = [(160000 + os.getpid() % 100000, 0, 1)]")));
  EXPECT_THAT(troubles, HasSubstr("a second run: event 1 is once tick"));
}

TEST_F(ChildCheck, EventsThatHangOnTheQuantaAreNamed) {
  const std::string troubles =
      troublesIn(check(childWith("out.append(struct.pack(\"<QHHHH\", tick,",
                                 "out.append(struct.pack(\"<QHHHH\", tick - (until % 8000 > 0),")));
  EXPECT_THAT(troubles, HasSubstr("a run in quanta of 0.17 ms instead of 0.5: event 1 is once tick 1000"));
  EXPECT_THAT(troubles, testing::Not(HasSubstr("a second run")));
}

TEST_F(ChildCheck, AnImageThatIsNotThereMustBeRefusedByError) {
  EXPECT_THAT(troublesIn(check(childWith("reply(ERROR, text(f\"{image}: {fault}\"))", "pass"))),
              HasSubstr("an image that is not there ends it without ERROR"));
  EXPECT_THAT(troublesIn(check(
                  childWith("            reply(ERROR, text(f\"{image}: {fault}\"))\n            sys.exit(1)",
                            "            pass"))),
              HasSubstr("an image that is not there is taken"));
}

TEST_F(ChildCheck, OneThatStopsIsToldWithItsWords) {
  EXPECT_THAT(
      troublesIn(check(childWith("struct.pack(\"<BQI\", 0, until,", "struct.pack(\"<BQI\", 1, until,"))),
      HasSubstr("it stops at tick 8000"));
  EXPECT_THAT(troublesIn(check(folder_.path() / "none")), HasSubstr("No such file"));
  EXPECT_THAT(troublesIn(check("/bin/true")), HasSubstr("exit status 0"));
}

}  // namespace
}  // namespace kerfbench::doctor
