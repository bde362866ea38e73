# SPDX-License-Identifier: Apache-2.0
# What is installed, and the Debian packages made of it. An installed bench lies as a built one does, so that its programs find
# each other and the images in the same way: PREFIX/lib/kerfbench/{bin,firmware,witness,window}; PREFIX/bin has links to the two programs
# that people start. Data is in PREFIX/share/kerfbench (hil/base/installation.h).
#
# Components, each a package: kerfbench, emulators (the children under the GPL), window, dev (headers, libraries, CMake package), doc.

set(kerfbench_private lib/kerfbench)
set(kerfbench_data share/kerfbench)

# --- kerfbench: programs and the data that they read
set(kerfbench_programs kerfbench kerfbench-instrument kerfplan kerfplan-scenario kerfbench-mcs51 kerfbench-cortex-m)
# They read what strangers send: their tables of functions cannot be overwritten.
get_property(native_releases GLOBAL PROPERTY KERFBENCH_NATIVE_RELEASES)
foreach(program IN ITEMS ${kerfbench_programs} kerfbench-avr kerfbench-sigrok kerfbench-window ${native_releases})
  if(TARGET ${program})
    target_link_options(${program} PRIVATE LINKER:-z,relro,-z,now)
  endif()
endforeach()
install(TARGETS ${kerfbench_programs} RUNTIME DESTINATION ${kerfbench_private}/bin COMPONENT kerfbench)
set(links ${PROJECT_BINARY_DIR}/installed_links)
file(MAKE_DIRECTORY ${links})
foreach(program IN ITEMS kerfbench kerfplan)
  file(CREATE_LINK ../${kerfbench_private}/bin/${program} ${links}/${program} SYMBOLIC)
  install(FILES ${links}/${program} DESTINATION bin COMPONENT kerfbench)
endforeach()

# Every image that a scenario may name. An .elf is for debuggers; some images have no other form.
install(TARGETS ${native_releases} RUNTIME DESTINATION ${kerfbench_private}/firmware COMPONENT kerfbench)
install(DIRECTORY ${PROJECT_BINARY_DIR}/firmware/ DESTINATION ${kerfbench_private}/firmware COMPONENT kerfbench
  FILES_MATCHING PATTERN "*.hex" PATTERN "*.parts" EXCLUDE)
install(DIRECTORY ${PROJECT_BINARY_DIR}/witness/ DESTINATION ${kerfbench_private}/witness COMPONENT kerfbench FILES_MATCHING PATTERN "*.py"
  PATTERN "__pycache__" EXCLUDE)
# Scenarios name machines, drawings and each other by relative paths: the folders stay beside each other.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/fixtures/ DESTINATION ${kerfbench_data} COMPONENT kerfbench
  PATTERN "__pycache__" EXCLUDE PATTERN "generate" EXCLUDE)
# Pages that programs read: what a key means, its range and its default.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/reference/ DESTINATION ${kerfbench_data}/reference COMPONENT kerfbench
  FILES_MATCHING PATTERN "*.md" PATTERN "*.json")

# What a CI's job runs; packaging/Containerfile and the templates call it there.
install(PROGRAMS packaging/ci/run_plan.sh packaging/ci/summary.py DESTINATION ${kerfbench_data}/ci COMPONENT kerfbench)

# --- emulators: programs of their own because of what they link
install(TARGETS kerfbench-avr kerfbench-sigrok RUNTIME DESTINATION ${kerfbench_private}/bin COMPONENT emulators)

# --- window: pages that are bundled by npm, where that was done, and the program that shows them
install(DIRECTORY ${PROJECT_BINARY_DIR}/window DESTINATION ${kerfbench_private} COMPONENT window OPTIONAL)
if(TARGET kerfbench-window)
  install(TARGETS kerfbench-window RUNTIME DESTINATION ${kerfbench_private}/bin COMPONENT window)
endif()

# --- man pages and completions, told by the programs themselves
set(user_files ${PROJECT_BINARY_DIR}/user_files)
set(telling kerfbench kerfbench-instrument kerfplan)
if(TARGET kerfbench-window)
  list(APPEND telling kerfbench-window)
endif()
add_custom_command(OUTPUT ${user_files}/stamp
  COMMAND ${CMAKE_COMMAND} -DBIN=${PROJECT_BINARY_DIR}/bin "-DPROGRAMS=${telling}" -DOUT=${user_files} -DCHANGELOG=${PROJECT_SOURCE_DIR}/packaging/debian/changelog
    -P ${PROJECT_SOURCE_DIR}/cmake/user_files.cmake
  DEPENDS ${telling} ${PROJECT_SOURCE_DIR}/packaging/debian/changelog ${PROJECT_SOURCE_DIR}/cmake/user_files.cmake
  VERBATIM)
add_custom_target(user_files DEPENDS ${user_files}/stamp)
install(DIRECTORY ${user_files}/man1 DESTINATION share/man COMPONENT kerfbench)
install(DIRECTORY ${user_files}/bash/ DESTINATION share/bash-completion/completions COMPONENT kerfbench)
install(DIRECTORY ${user_files}/zsh/ DESTINATION share/zsh/vendor-completions COMPONENT kerfbench)
install(DIRECTORY ${user_files}/fish/ DESTINATION share/fish/vendor_completions.d COMPONENT kerfbench)

# --- dev: find_package(kerfbench), a target for each room
get_property(rooms GLOBAL PROPERTY KERFBENCH_ROOMS)
# Commands of the programs are nothing to build upon.
list(REMOVE_ITEM rooms hil_app hil_instrument hil_window)
install(TARGETS kerfbench_options ${rooms} EXPORT kerfbench ARCHIVE DESTINATION ${kerfbench_private} COMPONENT dev)
install(EXPORT kerfbench NAMESPACE kerfbench:: FILE kerfbenchTargets.cmake DESTINATION lib/cmake/kerfbench COMPONENT dev)
include(CMakePackageConfigHelpers)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kerfbenchConfig.cmake.in ${PROJECT_BINARY_DIR}/kerfbenchConfig.cmake
  INSTALL_DESTINATION lib/cmake/kerfbench NO_SET_AND_CHECK_MACRO)
# While the first digit is 0, a new second digit may change everything.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kerfbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kerfbenchConfig.cmake ${PROJECT_BINARY_DIR}/kerfbenchConfigVersion.cmake
  DESTINATION lib/cmake/kerfbench COMPONENT dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/twin ${PROJECT_SOURCE_DIR}/hil ${PROJECT_SOURCE_DIR}/firmware_under_test
  DESTINATION include/kerfbench COMPONENT dev
  FILES_MATCHING PATTERN "*.h"
  PATTERN "firmware_under_test/faults" EXCLUDE PATTERN "own_jobs" EXCLUDE PATTERN "twin/validation" EXCLUDE
  PATTERN "avr_child" EXCLUDE PATTERN "mcs51_child" EXCLUDE PATTERN "cortex_m_child" EXCLUDE PATTERN "sigrok_child" EXCLUDE
  PATTERN "hil/app" EXCLUDE PATTERN "hil/instrument" EXCLUDE PATTERN "hil/planned_case" EXCLUDE PATTERN "hil/window" EXCLUDE PATTERN "planner/kerfplan" EXCLUDE
  PATTERN "controller/avr" EXCLUDE PATTERN "controller/mcs51" EXCLUDE PATTERN "controller/stm32" EXCLUDE PATTERN "controller/native" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION share/doc/kerfbench-dev COMPONENT dev)

# --- doc
# As a site, where cmark-gfm is installed; `./bench package` installs it.
find_program(CMARK_GFM cmark-gfm)
find_program(PYTHON3 python3)
if(CMARK_GFM AND PYTHON3)
  add_custom_target(site COMMAND ${PYTHON3} -B ${PROJECT_SOURCE_DIR}/docs/site/build_site.py ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/site VERBATIM)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/site/ DESTINATION share/doc/kerfbench-doc/html COMPONENT doc)
  install(FILES packaging/debian/kerfbench-doc.doc-base DESTINATION share/doc-base RENAME kerfbench-doc.kerfbench COMPONENT doc)
endif()

# --- what Debian asks of each package
foreach(component IN ITEMS kerfbench emulators window dev doc)
  set(package kerfbench-${component})
  if(component STREQUAL kerfbench)
    set(package kerfbench)
  endif()
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/copyright DESTINATION share/doc/${package} COMPONENT ${component})
  install(FILES ${user_files}/changelog.gz DESTINATION share/doc/${package} COMPONENT ${component})
  if(EXISTS ${PROJECT_SOURCE_DIR}/packaging/debian/${package}.lintian-overrides)
    install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/${package}.lintian-overrides DESTINATION share/lintian/overrides
      RENAME ${package} COMPONENT ${component})
  endif()
endforeach()

# All that is installed, built: `cmake --install` builds nothing.
add_custom_target(installable DEPENDS ${kerfbench_programs} kerfbench-avr kerfbench-sigrok firmware user_files ${rooms})
foreach(target IN ITEMS kerfbench-window site)
  if(TARGET ${target})
    add_dependencies(installable ${target})
  endif()
endforeach()

include(KerfbenchPackages)
