/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the belt does what the job takes for granted: docs/reference/controller.md. */
#ifndef KERFBENCH_CONTROLLER_WATCH_H
#define KERFBENCH_CONTROLLER_WATCH_H

#include "firmware_under_test/controller/protocol.h"

void kb_watch_start(void);
/* Once a period while running, after kb_belt_update(): KB_OK, KB_FAULT_ENCODER or KB_FAULT_BELT_FAST. */
enum kb_fault kb_watch_belt(void);

#endif
