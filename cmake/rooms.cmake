# Compiler settings of every target, and one static library per room.

add_library(softkin_settings INTERFACE)
target_include_directories(softkin_settings INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(softkin_settings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror -fno-math-errno
                       -ffp-contract=fast)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  target_compile_options(softkin_settings INTERFACE -Wno-psabi)  # no vector type crosses a library boundary
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # gcc 12 reports its own AVX-512 header and std::string
    target_compile_options(softkin_settings INTERFACE -Wno-maybe-uninitialized -Wno-uninitialized -Wno-restrict
                           -Wno-array-bounds -Wno-stringop-overflow)
  endif()
endif()
target_compile_definitions(softkin_settings INTERFACE SOFTKIN_VERSION="${PROJECT_VERSION}" EIGEN_DONT_PARALLELIZE)
target_link_libraries(softkin_settings INTERFACE Eigen3::Eigen Threads::Threads)
if(SOFTKIN_NATIVE)
  target_compile_options(softkin_settings INTERFACE -march=native)
endif()
if(SOFTKIN_SANITIZE)
  target_compile_options(softkin_settings INTERFACE -fsanitize=${SOFTKIN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(softkin_settings INTERFACE -fsanitize=${SOFTKIN_SANITIZE})
endif()

# softkin_precompile(TARGET [headers...]): what nearly every file of the target reads, read once
function(softkin_precompile target)
  if(SOFTKIN_PCH)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <algorithm> <cmath> <filesystem> <functional> <map> <memory>
                              <optional> <string> <vector> ${ARGN})
  endif()
endfunction()

# softkin_room(NAME [rooms and libraries it uses...]): every .cpp of the folder and of those in it
function(softkin_room name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  add_library(softkin_${name} STATIC ${sources})
  target_link_libraries(softkin_${name} PUBLIC softkin_settings ${ARGN})
  softkin_precompile(softkin_${name})
endfunction()
