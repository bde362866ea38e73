// SPDX-License-Identifier: Apache-2.0
#include "small_job.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/program/plan.h"
#include "player.h"

namespace kerfbench::planner::test {
namespace {

std::vector<int> bytesIn(const std::string& source) {
  std::vector<int> bytes;
  const std::size_t begin = source.find("job[] = {");
  std::istringstream text(source.substr(begin + 9, source.find("};", begin) - begin - 9));
  for (std::string item; std::getline(text, item, ',');) {
    if (item.find_first_of("0123456789") != std::string::npos) bytes.push_back(std::stoi(item));
  }
  return bytes;
}

}  // namespace

MachineParameters smallMachine() {
  MachineParameters machine = twoMirror();
  machine.print_mark_sensor_x_mm = -25.0;
  machine.field_min_mm[0] = -40.0, machine.field_max_mm[0] = 40.0;
  return machine;
}

JobParameters smallJob() {
  JobParameters job = mirrorJob();
  job.belt_speed_mm_s = 25.0;
  job.units = 3;
  job.pitch_mm = 32.0;
  job.eye_mark_x_mm = 0.0;
  job.mark_speed_mm_s = 80.0;
  job.jump_speed_mm_s = 100.0;
  return job;
}

OwnJob makeSmallJob(const Mcs51Controller& controller) {
  const dieline::Dieline drawing = dielineOf(
      {line(-17, -8, -3, -8), arc(-3, -5, 3, -90, 90), line(0, -5, 0, 5), arc(-3, 5, 3, 0, 90),
       line(-3, 8, -17, 8), arc(-17, 5, 3, 90, 90), line(-20, 5, -20, -5), arc(-17, -5, 3, 180, 90)});
  return makeOwnJob("small", makeGcode(drawing, smallMachine(), smallJob()), smallMachine(), smallJob(),
                    controller);
}

double distanceFromOutline(const Eigen::Vector2d& p_S_mm) {
  const Eigen::Vector2d from_middle = (p_S_mm - Eigen::Vector2d(-10, 0)).cwiseAbs();
  const Eigen::Vector2d beyond = from_middle - Eigen::Vector2d(7, 5);
  return std::abs(beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0) - 3.0);
}

std::vector<Shown> periodsIn(const std::string& source, const JobTable& table) {
  const std::vector<int> bytes = bytesIn(source);
  std::vector<Shown> shown;
  Shown now{Eigen::Vector2i::Zero(), Eigen::Vector2i::Ones(), -1, -1, 0};
  int power = -1;
  int units_left = table.units;
  for (std::size_t at = 0;;) {
    if (at + 1 >= bytes.size() || shown.size() > 100'000) {
      ADD_FAILURE() << "the table has no end";
      return shown;
    }
    const int b0 = bytes[at++];
    const int b1 = bytes[at++];
    if ((b1 & 4) != 0) {
      if (b0 == 0) return shown;
      if (b0 == 1) now.unit++, now.since_mark = 0;
      if (b0 == 2 && --units_left == 0) at = table.final;
      if (b0 == 3) at = table.loop;
      continue;
    }
    if ((b0 & 4) != 0) power = bytes.at(at++);
    const int runs = (b1 & 2) != 0 ? bytes.at(at++) : 1;
    now.dirs = {b0 & 1, b1 & 1};
    now.power = (b0 & 2) != 0 ? power : -1;
    for (int run = 0; run < runs; ++run) {
      now.steps.x() += (b0 >> 3) * (now.dirs.x() == 0 ? 1 : -1);
      now.steps.y() += (b1 >> 3) * (now.dirs.y() == 0 ? 1 : -1);
      ++now.since_mark;
      shown.push_back(now);
    }
  }
}

}  // namespace kerfbench::planner::test
