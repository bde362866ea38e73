/* SPDX-License-Identifier: Apache-2.0 */
/* Watch on the belt's motion, which the job relies on: docs/reference/controller.md. */
#ifndef KERFBENCH_CONTROLLER_WATCH_H
#define KERFBENCH_CONTROLLER_WATCH_H

#include "firmware_under_test/controller/protocol.h"

void kb_watch_start(void);
/* Checks the belt. Called once a period while running, after kb_belt_update(). KB_OK, KB_FAULT_ENCODER or
 * KB_FAULT_BELT_FAST. */
enum kb_fault kb_watch_belt(void);

#endif
