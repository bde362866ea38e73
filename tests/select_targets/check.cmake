# SPDX-License-Identifier: Apache-2.0
# cmake -DPYTHON=… -DSELECT=select_targets.py -DSOURCE=unbuilt -DWORK=FOLDER -P check.cmake
file(REMOVE_RECURSE ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${WORK} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

function(expect_targets expected)
  execute_process(COMMAND ${PYTHON} -B ${SELECT} ${WORK} ${ARGN} OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY)
  if(NOT found STREQUAL expected)
    message(FATAL_ERROR "select_targets ${ARGN}: '${found}' instead of '${expected}'")
  endif()
endfunction()
expect_targets("bin/data bin/one bin/two")
expect_targets("bin/data bin/one" -R first)
expect_targets("bin/two" -R second)
expect_targets("" -R third)
