# SPDX-License-Identifier: Apache-2.0
# The house's targets: one static library for each room (folder), one test program for each folder of tests.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(kerfbench_options INTERFACE)
# Warnings are for this project alone: who builds against an installed bench has a compiler and a taste of his own.
set(kerfbench_warnings
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # Only where the compiler is known: a visitor's may warn of something new.
  $<$<BOOL:${KERFBENCH_WERROR}>:-Werror>
  # GCC 12 sees overlaps and overflows in std::string operator+ that are not there (GCC bugs 105329, 105651), with
  # precompiled headers more of them; the sanitizers' build has clang++ and sees those that are.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-array-bounds>
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-stringop-overflow>
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-stringop-overread>
  # Of several sources in one it takes the anonymous namespaces for a header's.
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
target_compile_options(kerfbench_options INTERFACE
  "$<BUILD_INTERFACE:${kerfbench_warnings}>"
  # Fused multiply-adds and re-association would make the bytes depend on the compiler's mood.
  -ffp-contract=off
  # Nobody asks errno after a root: without it a loop with one takes several numbers at once, the results are the same.
  -fno-math-errno)
target_include_directories(kerfbench_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/kerfbench>)

# Where they are installed: ccache takes what was compiled before, and lld links in a sixth of the time.
find_program(KERFBENCH_CCACHE ccache)
if(KERFBENCH_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # A precompiled header is taken for what it was made of; paths below the project count from there.
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} ${KERFBENCH_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
  target_compile_options(kerfbench_options INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>>)
endif()
find_program(KERFBENCH_LLD ld.lld)
if(KERFBENCH_LLD)
  add_link_options(-fuse-ld=lld)
endif()
if(KERFBENCH_SANITIZE)
  target_compile_options(kerfbench_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # With sanitizers GCC 12 takes the std::function in std::regex for uninitialized, and members of a moved std::variant.
  target_compile_options(kerfbench_options INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-maybe-uninitialized>)
  # Left out are the checks of each single load and store: AddressSanitizer looks at these too (all but their alignment), and
  # they take a third of the build's time.
  target_compile_options(kerfbench_options INTERFACE
    $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=null,alignment,object-size,pointer-overflow,nonnull-attribute,returns-nonnull-attribute>)
  target_link_options(kerfbench_options INTERFACE -fsanitize=address,undefined)
  if(KERFBENCH_FUZZ)
    # A place beyond the end of a std::vector that is within its memory is a fault as well.
    target_compile_options(kerfbench_options INTERFACE -fsanitize=fuzzer-no-link -D_GLIBCXX_ASSERTIONS)
  endif()
  # In the tests' own sources Eigen's templates under the second sanitizer take longer than all that they test.
  set(kerfbench_test_options -fno-sanitize=undefined)
elseif(CMAKE_BUILD_TYPE STREQUAL Release)
  # A test's own source runs once for each time that it is compiled.
  set(kerfbench_test_options -O1)
endif()

# What nearly every source includes, read by the compiler once instead of 700 times: it halves the time of a build. Each
# source still includes what it uses; clang-tidy reads them without this (.ci/run).
function(kerfbench_precompile_headers)
  set(common <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers> <optional>
    <span> <sstream> <stdexcept> <string> <vector> <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <fmt/format.h>)
  file(WRITE ${PROJECT_BINARY_DIR}/no_source.cpp "")
  add_library(kerfbench_common_headers OBJECT ${PROJECT_BINARY_DIR}/no_source.cpp)
  target_link_libraries(kerfbench_common_headers PRIVATE kerfbench_options Eigen3::Eigen fmt::fmt)
  target_precompile_headers(kerfbench_common_headers PRIVATE ${common})
  if(NOT KERFBENCH_TESTS)
    return()
  endif()
  add_library(kerfbench_test_headers OBJECT ${PROJECT_BINARY_DIR}/no_source.cpp)
  target_link_libraries(kerfbench_test_headers PRIVATE kerfbench_options Eigen3::Eigen fmt::fmt GTest::gtest GTest::gmock)
  target_compile_options(kerfbench_test_headers PRIVATE ${kerfbench_test_options})
  target_precompile_headers(kerfbench_test_headers PRIVATE ${common} <gmock/gmock.h> <gtest/gtest.h>)
endfunction()

# kerfbench_library(sigrok_child SOURCES a.cpp PUBLIC kerfbench::hil_source PRIVATE opencv_core)
function(kerfbench_library name)
  cmake_parse_arguments(ARG "COMPUTES" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  # Most of a source's time goes into what it includes: several are compiled as one.
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${KERFBENCH_UNITY} UNITY_BUILD_BATCH_SIZE 24)
  add_library(kerfbench::${name} ALIAS ${name})
  target_link_libraries(${name} PUBLIC kerfbench_options Eigen3::Eigen ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} fmt::fmt)
  target_precompile_headers(${name} REUSE_FROM kerfbench_common_headers)
endfunction()

# A room of the house: the library of a folder. Its links are the rooms that it includes, no more and no fewer:
# tests/structure compares this list with the sources. COMPUTES: a room of sums over very many numbers, in which the sanitizers' tests
# spend most of their time; it is optimised for them, too.
function(kerfbench_room name)
  kerfbench_library(${name} ${ARGN})
  cmake_parse_arguments(ARG "COMPUTES" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(KERFBENCH_SANITIZE AND ARG_COMPUTES)
    target_compile_options(${name} PRIVATE -O2)
  endif()
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_property(GLOBAL APPEND PROPERTY KERFBENCH_ROOMS ${name})
  set_property(GLOBAL PROPERTY KERFBENCH_ROOM_${name} ${folder})
  list(FILTER ARG_PUBLIC INCLUDE REGEX "^kerfbench::")
  list(FILTER ARG_PRIVATE INCLUDE REGEX "^kerfbench::")
  set_property(GLOBAL PROPERTY KERFBENCH_LINKS_${name} ${ARG_PUBLIC} ${ARG_PRIVATE})
endfunction()

# kerfbench_program(kerfbench SOURCES main.cpp LIBS kerfbench::hil_app): a program with a command line. CLI11 takes longer to
# compile than all the rest of these files: they are one translation unit, which nothing that is slow passes through.
function(kerfbench_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  add_executable(${name} ${ARG_SOURCES}
    ${PROJECT_SOURCE_DIR}/hil/command_line/command_tree_cli.cpp ${PROJECT_SOURCE_DIR}/hil/command_line/dialogue_cli.cpp)
  target_link_libraries(${name} PRIVATE kerfbench_options ${ARG_LIBS} kerfbench::hil_command_line CLI11::CLI11 fmt::fmt)
  if(CMAKE_BUILD_TYPE STREQUAL Release)
    target_compile_options(${name} PRIVATE -O1)
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin UNITY_BUILD ${KERFBENCH_UNITY} UNITY_BUILD_BATCH_SIZE 0)
endfunction()

# build/…/rooms.txt: a line for each room, "hil/vision/spot: hil/base hil/camera …", in the order in which they are built.
function(kerfbench_write_rooms)
  get_property(rooms GLOBAL PROPERTY KERFBENCH_ROOMS)
  set(text "")
  foreach(room IN LISTS rooms)
    get_property(folder GLOBAL PROPERTY KERFBENCH_ROOM_${room})
    get_property(links GLOBAL PROPERTY KERFBENCH_LINKS_${room})
    set(line "${folder}:")
    list(SORT links)
    foreach(link IN LISTS links)
      string(REPLACE "kerfbench::" "" link ${link})
      get_property(target GLOBAL PROPERTY KERFBENCH_ROOM_${link})
      string(APPEND line " ${target}")
    endforeach()
    string(APPEND text "${line}\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/rooms.txt CONTENT "${text}" @ONLY)
endfunction()

# What ctest -L unit runs.
add_custom_target(unit_tests)

# A test program of the objects that the build KERFBENCH_TEST_OBJECTS has of the test's own sources, and of this build's rooms. The rooms
# under test come first and whole: where both have a copy of a function of a header, the linker takes the first.
function(kerfbench_link_test_objects name)
  set(list ${KERFBENCH_TEST_OBJECTS}/test_objects/${name}.txt)
  if(NOT EXISTS ${list})
    message(FATAL_ERROR "There is no ${list}: KERFBENCH_TEST_OBJECTS is the folder of a build whose tests were built before.")
  endif()
  file(READ ${list} objects)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${list})
  set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  add_executable(${name}_test ${objects})
  set_target_properties(${name}_test PROPERTIES LINKER_LANGUAGE CXX)
  list(TRANSFORM ARGN REPLACE "^kerfbench::" "" OUTPUT_VARIABLE rooms)
  get_property(all_rooms GLOBAL PROPERTY KERFBENCH_ROOMS)
  foreach(room IN LISTS rooms)
    if(room IN_LIST all_rooms)
      target_link_options(${name}_test PRIVATE "LINKER:--whole-archive,$<TARGET_FILE:${room}>,--no-whole-archive")
    endif()
  endforeach()
endfunction()

# kerfbench_test(twin_optics SOURCES a_test.cpp LIBS kerfbench::twin_optics LABELS unit)
# ALONE: those of SOURCES that are not compiled as one with others, because they give a name of their own another meaning.
# LONG: tests of very many cases and whole live runs, as a gtest filter. They are a test of their own, NAME_long, that only `./bench test --all`
# runs. The sanitizers' build has none of them: what it looks for is in the first case as in the thousandth; nor the tests of NOT_SANITIZED.
# OWN_OBJECTS: the sources name programs of their own build, or replace a function of the room: no other build links their objects
# (KERFBENCH_TEST_OBJECTS).
function(kerfbench_test name)
  cmake_parse_arguments(ARG "OWN_OBJECTS" "TIMEOUT;LONG;NOT_SANITIZED" "SOURCES;ALONE;LIBS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(KERFBENCH_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 4")  # A net against hangs, not a measure of speed.
  endif()
  if(KERFBENCH_TEST_OBJECTS AND NOT ARG_OWN_OBJECTS)
    kerfbench_link_test_objects(${name} ${ARG_LIBS})
  else()
    add_executable(${name}_test ${ARG_SOURCES})
    target_compile_options(${name}_test PRIVATE ${kerfbench_test_options})
    target_precompile_headers(${name}_test REUSE_FROM kerfbench_test_headers)
    set_target_properties(${name}_test PROPERTIES UNITY_BUILD ${KERFBENCH_UNITY} UNITY_BUILD_BATCH_SIZE 14)
    set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    list(FILTER ARG_SOURCES INCLUDE REGEX "\\.c$")
    set_source_files_properties(${ARG_SOURCES} PROPERTIES SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
    target_compile_definitions(${name}_test PRIVATE
      KERFBENCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}" KERFBENCH_BINARY_DIR="${PROJECT_BINARY_DIR}")
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/test_objects/${name}.txt CONTENT "$<TARGET_OBJECTS:${name}_test>")
  endif()
  target_link_libraries(${name}_test PRIVATE kerfbench_options ${ARG_LIBS} fmt::fmt GTest::gtest GTest::gmock GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name}_test)
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
  set(left_out ${ARG_LONG})
  if(KERFBENCH_SANITIZE)
    list(APPEND left_out ${ARG_NOT_SANITIZED})
  endif()
  if(left_out)
    list(JOIN left_out ":" left_out)
    set_tests_properties(${name} PROPERTIES ENVIRONMENT "GTEST_FILTER=-${left_out}")
  endif()
  if(ARG_LONG AND NOT KERFBENCH_SANITIZE)
    add_test(NAME ${name}_long COMMAND ${name}_test)
    set_tests_properties(${name}_long PROPERTIES LABELS long TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT "GTEST_FILTER=${ARG_LONG}")
  endif()
  if(ARG_LABELS STREQUAL unit)
    add_dependencies(unit_tests ${name}_test)
  endif()
endfunction()
