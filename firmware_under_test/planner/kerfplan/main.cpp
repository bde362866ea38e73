// SPDX-License-Identifier: Apache-2.0
// kerfplan: the host half of the reference controller as a program of its own, without the bench.
#include "firmware_under_test/planner/kerfplan/kerfplan.h"

int main(int argc, char** argv) { return kerfbench::planner::kerfplanMain(argc, argv, {}); }
