# Compiler flags, chosen once for the whole project (docs/decisions/0001-floating-point.md).

set(CMAKE_CXX_STANDARD 23)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3")
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

# Instruction set: a value of -march, or "native". x86-64-v3 is AVX2 with FMA, x86-64-v4 AVX-512, armv8-a NEON.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(STILT_ISA_DEFAULT x86-64-v3)
elseif(CMAKE_CROSSCOMPILING AND CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(STILT_ISA_DEFAULT armv8-a)
else()
  set(STILT_ISA_DEFAULT native)
endif()
set(STILT_ISA ${STILT_ISA_DEFAULT} CACHE STRING "Instruction set: a value of -march")
set(STILT_SANITIZE "" CACHE STRING "Sanitizers: 'address,undefined' or 'thread'")

# What is the same for all instruction sets, and the whole.
add_library(stilt_common_flags INTERFACE)
add_library(stilt_flags INTERFACE)
target_link_libraries(stilt_flags INTERFACE stilt_common_flags)
target_include_directories(stilt_common_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(stilt_common_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -Wno-psabi
  # Results may depend on the build, never on the run: no -ffast-math (NaN must stay visible). Multiply-add contraction
  # is allowed, errno and traps of mathematical functions are unused.
  -ffp-contract=fast -fno-math-errno -fno-trapping-math)
# Eigen's assertions would end the program in the real-time path; debug builds keep them.
target_compile_definitions(stilt_common_flags INTERFACE $<$<CONFIG:Release>:EIGEN_NO_DEBUG>)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # The layout of Eigen's types must not depend on the instruction set: code for several is linked together.
  target_compile_definitions(stilt_common_flags INTERFACE EIGEN_MAX_STATIC_ALIGN_BYTES=64)
endif()
# GCC 12's AVX-512 headers use uninitialised registers on purpose, which gives warnings.
set(avx512_options -mprefer-vector-width=512 -Wno-maybe-uninitialized -Wno-uninitialized)
set(STILT_AVX512_FLAGS -march=x86-64-v4 ${avx512_options})
target_compile_options(stilt_flags INTERFACE -march=${STILT_ISA})
if(STILT_ISA STREQUAL "x86-64-v4" OR STILT_ISA STREQUAL "native")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    # A column of 7 numbers never enters a loop over 8 of them, but GCC 12 warns of a read beyond its end.
    target_compile_options(stilt_flags INTERFACE ${avx512_options} -Wno-array-bounds)
  endif()
endif()
if(STILT_SANITIZE)
  # GCC 12 takes what the sanitizers insert into <regex> for uninitialised values.
  target_compile_options(stilt_flags INTERFACE
    -fsanitize=${STILT_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(stilt_flags INTERFACE -fsanitize=${STILT_SANITIZE})
  if(STILT_SANITIZE STREQUAL "thread")
    target_compile_options(stilt_flags INTERFACE -Wno-tsan)  # of fences, which Boost has
  endif()
endif()
