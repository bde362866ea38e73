// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/serve/answer.h"
#include "hil/serve/desk_routes.h"
#include "hil/serve/work_folder.h"

namespace kerfbench::serve {

/// A file that a user brings into the folder, PUT /api/files?path=P&as=new or as=replace: it is read before
/// it is written. A drawing of which nothing can be cut leaves nothing behind; the same bytes are not written
/// twice; another file of the name is replaced only where that is said. May be used by several threads.
class Arrivals {
 public:
  Arrivals(const WorkFolder& files, DeskRoutes& desk) : files_(files), desk_(desk) {}

  /// Gives {"path", "was_there": bool}. @throws Refusal 400 for a drawing that cannot be cut and a body that
  /// is not whole, 409 for a name that another file has; as WorkFolder::write().
  [[nodiscard]] Answer take(const Asked& asked) const;

 private:
  const WorkFolder& files_;
  DeskRoutes& desk_;
};

/// Hands on the bytes of a request. @throws Refusal 400 for a body that does not come as a whole.
void readWhole(const Asked& asked, const std::function<void(std::string_view)>& take);

}  // namespace kerfbench::serve
