# SPDX-License-Identifier: Apache-2.0
# The house's targets: one static library per folder, one test program per folder of tests.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(kerfbench_options INTERFACE)
target_compile_options(kerfbench_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
  # GCC 12 sees overlaps in std::string operator+ that are not there (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # Fused multiply-adds and re-association would make the bytes depend on the compiler's mood.
  -ffp-contract=off)
target_include_directories(kerfbench_options INTERFACE ${PROJECT_SOURCE_DIR})
if(KERFBENCH_SANITIZE)
  target_compile_options(kerfbench_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # With sanitizers GCC 12 takes the std::function in std::regex for uninitialized.
  target_compile_options(kerfbench_options INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)
  target_link_options(kerfbench_options INTERFACE -fsanitize=address,undefined)
endif()

# kerfbench_library(twin_optics SOURCES a.cpp PUBLIC kerfbench::twin_base PRIVATE opencv_core)
function(kerfbench_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  add_library(kerfbench::${name} ALIAS ${name})
  target_link_libraries(${name} PUBLIC kerfbench_options ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# kerfbench_test(twin_optics SOURCES a_test.cpp LIBS kerfbench::twin_optics LABELS unit)
function(kerfbench_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(KERFBENCH_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 4")  # A net against hangs, not a measure of speed.
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  target_link_libraries(${name}_test PRIVATE kerfbench_options ${ARG_LIBS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name}_test PRIVATE KERFBENCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}" KERFBENCH_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name}_test)
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
endfunction()
