# SPDX-License-Identifier: Apache-2.0
# cmake -DBIN=build/…/bin "-DPROGRAMS=kerfbench;kerfplan" -DOUT=FOLDER -DCHANGELOG=FILE -P user_files.cmake: the man pages and completions that the programs tell of
# themselves, and Debian's changelog, packed without a time so that their bytes are the same each time.
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/man1 ${OUT}/bash ${OUT}/zsh ${OUT}/fish)
set(ENV{NO_COLOR} 1)
foreach(program IN LISTS PROGRAMS)
  execute_process(COMMAND ${BIN}/${program} man --out ${OUT}/man1 COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(program IN ITEMS kerfbench kerfplan)
  execute_process(COMMAND ${BIN}/${program} completion bash OUTPUT_FILE ${OUT}/bash/${program} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${BIN}/${program} completion zsh OUTPUT_FILE ${OUT}/zsh/_${program} COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${BIN}/${program} completion fish OUTPUT_FILE ${OUT}/fish/${program}.fish COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(GLOB pages ${OUT}/man1/*.1)
configure_file(${CHANGELOG} ${OUT}/changelog COPYONLY)
execute_process(COMMAND gzip -9 -n ${pages} ${OUT}/changelog COMMAND_ERROR_IS_FATAL ANY)
file(TOUCH ${OUT}/stamp)
