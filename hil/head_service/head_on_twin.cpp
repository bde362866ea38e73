// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_on_twin.h"

#include <fmt/format.h>

#include <utility>

#include "hil/base/atomic_file.h"
#include "hil/calibrate/tables/csv_table.h"

namespace kerfbench::head_service {

HeadOnTwin::HeadOnTwin(const HeadSetup& setup, TwinBench bench, std::filesystem::path results)
    : setup_(&setup), bench_(std::move(bench)), results_(std::move(results)) {}

MeasuredSheet HeadOnTwin::operator()(const SheetOrder& order) const {
  const std::string& name = order.job.name;
  SheetRequest request{order.job, order.sheet, results_ / name, setup_->table_file};
  if (order.round > 0) {
    std::filesystem::create_directories(results_);
    request.table = results_ / fmt::format("correction-{}.csv", order.round);
    base::writeFileAtomically(request.table, calibrate::csvTable(order.table.value()));
  }
  SheetOnTwin done = sheetOnTwin(*setup_, bench_, request, [&](double now_s, const std::string& what) {
    if (progress) progress(name, now_s, what);
  });
  if (done.was_there && was_there) was_there(name);
  return std::move(done.measured);
}

}  // namespace kerfbench::head_service
