# How every target of this project is compiled, what its users are told, and one static library per room.

# For this project alone: nothing of it reaches whoever links softkin.
add_compile_options(-Wall -Wextra -Wpedantic -Wshadow -fno-math-errno -ffp-contract=fast)
add_compile_options(-Wno-psabi)  # no vector type crosses a library boundary
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # gcc 12 reports its own AVX-512 header and std::string
  add_compile_options(-Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict -Wno-array-bounds
                      -Wno-stringop-overflow -Wno-stringop-overread)
endif()
add_compile_definitions(SOFTKIN_VERSION="${PROJECT_VERSION}" EIGEN_DONT_PARALLELIZE)
if(SOFTKIN_ARCH)
  add_compile_options(-march=${SOFTKIN_ARCH})
elseif(SOFTKIN_NATIVE)
  add_compile_options(-march=native)
endif()
if(NOT SOFTKIN_SANITIZE)
  add_compile_options(-Werror)  # another compiler, and what sanitizers insert, warn of more
else()
  add_compile_options(-fsanitize=${SOFTKIN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${SOFTKIN_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang AND SOFTKIN_SANITIZE MATCHES undefined)
    # Eigen's blocks of empty matrices are places past a null pointer, which nothing reads
    add_compile_options(-fno-sanitize=pointer-overflow)
  endif()
endif()
# For every target alike, programs too: they share precompiled headers, the Python package can be built where they were,
# and command and package give the same bits.
add_compile_options(-fPIC -fno-semantic-interposition)

# What users get too. Eigen chooses by -march how it aligns, and with it how it allocates and frees: a matrix of a room
# built for AVX-512 would crash a user's program built for any x86-64. So both are told one alignment. Of those that
# suit every machine (16 and 64) 64 it is: sums of vectors that begin between two packets would depend on the address.
add_library(softkin_settings INTERFACE)
set_target_properties(softkin_settings PROPERTIES EXPORT_NAME settings)
target_include_directories(softkin_settings INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
                           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(softkin_settings INTERFACE cxx_std_20)
target_compile_definitions(softkin_settings INTERFACE EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=64)
target_link_libraries(softkin_settings INTERFACE Eigen3::Eigen Threads::Threads)

# What nearly every file reads, read once for all targets: softkin_precompile(TARGET).
set(softkin_precompiled <Eigen/Core> <algorithm> <cmath> <filesystem> <functional> <map> <memory> <optional> <string>
                        <vector>)
function(softkin_precompile target)
  if(NOT SOFTKIN_PCH)
    return()
  endif()
  if(TARGET softkin_core AND NOT target STREQUAL softkin_core)
    target_precompile_headers(${target} REUSE_FROM softkin_core)
  else()
    target_precompile_headers(${target} PRIVATE ${softkin_precompiled})
  endif()
endfunction()

# softkin_compile_together(TARGET): its files in groups, for half the work; not rooms with inner loops, which came out
# fastest file by file
function(softkin_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SOFTKIN_UNITY} UNITY_BUILD_BATCH_SIZE 10)
  # a class of a test file is nobody else's
  target_compile_options(${target} PRIVATE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${SOFTKIN_UNITY}>>:-Wno-subobject-linkage>)
endfunction()

# softkin_room(NAME [rooms and libraries it uses...]): every .cpp of the folder and of those in it
function(softkin_room name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  add_library(softkin_${name} STATIC ${sources})
  target_link_libraries(softkin_${name} PUBLIC softkin_settings ${ARGN})
  set_target_properties(softkin_${name} PROPERTIES EXPORT_NAME ${name})
  softkin_precompile(softkin_${name})
endfunction()
