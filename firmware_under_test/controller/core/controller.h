/* SPDX-License-Identifier: Apache-2.0 */
/* The controller as a whole: kb_controller_init() once, kb_controller_poll() for ever. A target adds the
 * interrupts: the tick (engine.h), encoder and mark edges (belt.h), and the functions of its hal.h. */
#ifndef KERFBENCH_CONTROLLER_CONTROLLER_H
#define KERFBENCH_CONTROLLER_CONTROLLER_H

#include "firmware_under_test/controller/protocol.h"

#ifdef __cplusplus
extern "C" {
#endif
/* Starts the controller. KB_OK after power-on, or the cause of the reset, which leads to KB_STOPPED. */
void kb_controller_init(enum kb_fault reset_cause);
void kb_controller_poll(void);
#ifdef __cplusplus
}
#endif

#endif
