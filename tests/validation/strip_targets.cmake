# SPDX-License-Identifier: Apache-2.0
# S0, the strip: its motion generator, and the run of ten thousand pieces as a command of its own.
kerfbench_library(validation_strip
  SOURCES strip_controller.cpp strip_line.cpp strip_record.cpp strip_track.cpp strip_twin.cpp
  PUBLIC kerfbench::twin_cutter
  PRIVATE kerfbench::hil_app fmt::fmt)
kerfbench_test(validation_strip SOURCES strip_controller_test.cpp LIBS kerfbench::validation_strip)

add_executable(kerfbench-strip strip_main.cpp)
target_link_libraries(kerfbench-strip PRIVATE kerfbench::validation_strip CLI11::CLI11 fmt::fmt)
target_compile_definitions(kerfbench-strip PRIVATE KERFBENCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
set_target_properties(kerfbench-strip PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
