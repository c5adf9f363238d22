# How every target of this project is compiled, what its users are told, and one static library per module.

# For this project alone: nothing of it reaches whoever links softkin.
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -fno-math-errno -ffp-contract=fast)
add_compile_options(-Wno-psabi)  # no vector type crosses a library boundary
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # gcc 12 reports its own AVX-512 header and std::string
  add_compile_options(-Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict -Wno-array-bounds
                      -Wno-stringop-overflow -Wno-stringop-overread)
endif()
cmake_host_system_information(RESULT softkin_memory_MiB QUERY TOTAL_PHYSICAL_MEMORY)
cmake_host_system_information(RESULT softkin_cores QUERY NUMBER_OF_LOGICAL_CORES)
# as many compilers as ninja starts may each take half of their share before they collect garbage: a tenth of their time
math(EXPR softkin_compiler_KiB "512 * ${softkin_memory_MiB} / (${softkin_cores} + 2)")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND softkin_compiler_KiB GREATER 262144)
  add_compile_options(--param=ggc-min-heapsize=${softkin_compiler_KiB})
endif()
add_compile_definitions(SOFTKIN_VERSION="${PROJECT_VERSION}" EIGEN_DONT_PARALLELIZE)
# by the compilers that it is made with; later ones, and what sanitizers insert, warn of more, which ends nobody's build
if((CMAKE_CXX_COMPILER_ID STREQUAL Clang AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15 OR
    CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13) AND NOT SOFTKIN_SANITIZE)
  add_compile_options(-Werror)
endif()
if(SOFTKIN_SANITIZE)
  # what libFuzzer watches is marked in the modules whose readers it is given alone: an eighth of the compiler's time
  string(REGEX REPLACE ",?fuzzer-no-link" "" softkin_sanitizers ${SOFTKIN_SANITIZE})
  set(softkin_fuzzed softkin_core softkin_model softkin_io softkin_drive softkin_runs fuzz_main softkin_fuzz softkin_fuzz_journals)
  add_compile_options(-fsanitize=${softkin_sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${softkin_sanitizers})
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang AND SOFTKIN_SANITIZE MATCHES undefined)
    add_compile_options(-fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/not_sanitized.txt)
    # Eigen's blocks of empty matrices are places past a null pointer, which nothing reads. What is read past a null
    # pointer or an object the address sanitizer finds, too: a tenth of the compiler's time.
    add_compile_options(-fno-sanitize=pointer-overflow,null,object-size)
  endif()
endif()
# For every target alike, programs too: they share precompiled headers, the Python package can be built where they were,
# and command and package give the same bits.
add_compile_options(-fPIC -fno-semantic-interposition)

# What users get too. Eigen chooses by -march how it aligns, and with it how it allocates and frees: a matrix of a module
# built for AVX-512 would crash a user's program built for any x86-64. So both are told one alignment. Of those that
# suit every machine (16 and 64) 64 it is: sums of vectors that begin between two packets would depend on the address.
add_library(softkin_settings INTERFACE)
set_target_properties(softkin_settings PROPERTIES EXPORT_NAME settings)
target_include_directories(softkin_settings INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(softkin_settings INTERFACE cxx_std_20)
target_compile_definitions(softkin_settings INTERFACE EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=64)
target_link_libraries(softkin_settings INTERFACE Eigen3::Eigen Threads::Threads)

# softkin_under_sanitizers(TARGET): what libFuzzer watches; and optimised is what spends its time in loops of its own, as
# for all else the compiler takes four fifths more if it is.
function(softkin_under_sanitizers target)
  if(SOFTKIN_SANITIZE MATCHES fuzzer AND target IN_LIST softkin_fuzzed)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  if(SOFTKIN_SANITIZE MATCHES address AND target MATCHES "_(linear|energy|contact)(_plain)?$")
    target_compile_options(${target} PRIVATE -O1)
    set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  endif()
endfunction()

# What nearly every file reads, read once for all targets with the same flags: softkin_precompile(TARGET).
set(softkin_precompiled <Eigen/Core> <algorithm> <cmath> <filesystem> <functional> <map> <memory> <optional> <string>
                        <vector>)
function(softkin_precompile target)
  softkin_under_sanitizers(${target})
  if(NOT SOFTKIN_PCH)
    return()
  endif()
  set(owner softkin_core)
  if(SOFTKIN_SANITIZE MATCHES fuzzer AND NOT target IN_LIST softkin_fuzzed)
    set(owner softkin_statics)
  endif()
  if(TARGET ${owner} AND NOT target STREQUAL owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
  else()
    target_precompile_headers(${target} PRIVATE ${softkin_precompiled})
  endif()
endfunction()

# softkin_compile_together(TARGET): its files in groups, for half the work; not kernels. So what a file has for itself has
# a name that no other file of its module gives to something else. Groups of 20 take up to a fifth less of the compiler's
# time than those of 10, and up to 3.4 GiB each in place of 2 (gcc); those of 40 another fifth less, but keep few
# processors busy.
set(softkin_group 20)
math(EXPR softkin_large_groups_MiB "3000 * (${softkin_cores} + 2)")
if(softkin_memory_MiB LESS softkin_large_groups_MiB)
  set(softkin_group 10)
elseif(softkin_cores LESS 4 AND CMAKE_CXX_COMPILER_ID STREQUAL Clang)
  set(softkin_group 40)
endif()
function(softkin_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SOFTKIN_UNITY} UNITY_BUILD_BATCH_SIZE ${softkin_group})
  # What clang inlines beyond this makes little faster, and takes it up to a fifth of its time; any two of its levels share
  # a precompiled header, which those of gcc do not.
  if(target MATCHES "^softkin_(linear|energy|contact)$")
    set(level -O3)
  elseif(target MATCHES "^softkin_(core|model|io|statics|kinematics)$")
    set(level "-O2 -mllvm -inline-threshold=100")
  else()
    set(level "-O1 -mllvm -inline-threshold=50")
  endif()
  # a class of a test file is nobody else's, and what only another file of its group knows hides nothing
  target_compile_options(${target} PRIVATE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${SOFTKIN_UNITY}>>:-Wno-subobject-linkage>
                         $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:${SOFTKIN_UNITY}>>:-Wno-shadow>
                         $<$<AND:$<CXX_COMPILER_ID:Clang>,$<CONFIG:Release>>:SHELL:${level}>)
endfunction()

# What has inner loops, the folder `kernels` of a module, is compiled for each of these; the best that the machine has is
# chosen when the program starts (src/softkin/core/target.hpp). All else is compiled for any processor.
if(SOFTKIN_PLAIN)
  set(softkin_targets plain)
  add_compile_definitions(SOFTKIN_PLAIN)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(softkin_targets sse4 avx2 avx512)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(softkin_targets neon)
else()
  set(softkin_targets plain)
endif()
set(softkin_flags_sse4 -msse4.2 -mpopcnt)
set(softkin_flags_avx2 ${softkin_flags_sse4} -mavx2 -mfma)
set(softkin_flags_avx512 ${softkin_flags_avx2} -mavx512f -mavx512bw -mavx512dq -mavx512vl -mprefer-vector-width=512)
set(softkin_bytes_avx2 32)
set(softkin_bytes_avx512 64)

# softkin_kernels(MODULE FILES...): compiled for every target, into the module's library. They have no precompiled header,
# whose inline functions would be taken for all of the program (tests/check_kernels.cmake looks that there are none).
function(softkin_kernels module)
  foreach(target ${softkin_targets})
    set(bytes ${softkin_bytes_${target}})
    if(NOT bytes)
      set(bytes 16)
    endif()
    set(kernels softkin_${module}_${target})
    add_library(${kernels} OBJECT ${ARGN})
    target_link_libraries(${kernels} PRIVATE softkin_settings)
    softkin_under_sanitizers(${kernels})
    target_compile_options(${kernels} PRIVATE ${softkin_flags_${target}})
    target_compile_definitions(${kernels} PRIVATE SOFTKIN_TARGET=${target} SOFTKIN_VECTOR_BYTES=${bytes})
    if(softkin_targets MATCHES sse4 AND CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12)
      # for any x86-64 gcc copies packs by 16 bytes, which what reads whole vectors then waits for, and what is made of
      # many by `rep movs`, which takes longer to begin than they take
      math(EXPR bits "8 * ${bytes}")
      target_compile_options(${kernels} PRIVATE -mmove-max=${bits} -mstore-max=${bits}
                             -mmemcpy-strategy=vector_loop:-1:noalign -mmemset-strategy=vector_loop:-1:noalign)
    endif()
    target_sources(softkin_${module} PRIVATE $<TARGET_OBJECTS:${kernels}>)
  endforeach()
endfunction()

# softkin_module(NAME [modules and libraries it uses...]): every .cpp of the folder and of those in it, but for `linked`, which
# is vision's alone
function(softkin_module name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  set(kernels ${sources})
  list(FILTER kernels INCLUDE REGEX "/kernels/")
  list(FILTER sources EXCLUDE REGEX "/(kernels|linked)/")
  add_library(softkin_${name} STATIC ${sources})
  if(kernels)
    softkin_kernels(${name} ${kernels})
  endif()
  target_link_libraries(softkin_${name} PUBLIC softkin_settings ${ARGN})
  set_target_properties(softkin_${name} PROPERTIES EXPORT_NAME ${name})
  softkin_precompile(softkin_${name})
  softkin_compile_together(softkin_${name})
endfunction()
