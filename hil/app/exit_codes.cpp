// SPDX-License-Identifier: Apache-2.0
#include "hil/app/exit_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "firmware_under_test/planner/plan.h"
#include "hil/app/commands.h"
#include "hil/app/release.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "twin/machine/divergence.h"

namespace kerfbench::hil {

int guarded(const std::filesystem::path& scenario, const std::function<int()>& work) {
  try {
    return work();
  } catch (const ConfigError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const DielineError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const planner::PlanError& e) {
    std::fputs(fmt::format("the job cannot be planned: {}\n", e.what()).c_str(), stderr);
  } catch (const twin::DivergenceError& e) {
    std::fputs(fmt::format("{}: {}; no verdict\n", scenario.string(), e.what()).c_str(), stderr);
    return kExitBroken;
  } catch (const InputFault& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  }
  return kExitInput;
}

int gravest(int a, int b) {
  constexpr std::array kGravity{0, 4, 1, 3, kExitInput, kExitBroken};
  const auto rank = [&](int code) { return std::ranges::find(kGravity, code) - kGravity.begin(); };
  return rank(a) >= rank(b) ? a : b;
}

}  // namespace kerfbench::hil
