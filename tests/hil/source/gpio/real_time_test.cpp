// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/real_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/hil/source/gpio/scripted_kernel.h"

namespace kerfbench::source {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(RealTime, IsTakenWhileItLivesAndGivenBack) {
  const auto kernel = std::make_shared<ScriptedKernel>();
  {
    const RealTime real_time(kernel);
    EXPECT_THAT(real_time.notes(), IsEmpty());
    EXPECT_EQ(kernel->real_time, 1);
  }
  EXPECT_EQ(kernel->real_time, 0);
}

TEST(RealTime, WhatIsNotAllowedIsSaidWithWhatToDo) {
  const auto kernel = std::make_shared<ScriptedKernel>();
  kernel->priority_error = EPERM;
  kernel->lock_error = ENOMEM;
  EXPECT_THAT(RealTime(kernel).notes(),
              ElementsAre(AllOf(HasSubstr("no real-time priority"), HasSubstr("rtprio 49")),
                          AllOf(HasSubstr("not locked"), HasSubstr("memlock"))));
}

}  // namespace
}  // namespace kerfbench::source
