# Language level, warnings and sanitizers: the same for every target of the project.
set(CMAKE_CXX_STANDARD 23)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET default)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo)
endif()

set(CNC_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
    -Wnon-virtual-dtor -Woverloaded-virtual -Wformat=2 -Wimplicit-fallthrough
    -Werror)

# clang 16 cannot see libstdc++ 12's <expected>: the header asks for a value of __cpp_concepts that
# this clang does not announce, though it implements what the header uses.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  add_compile_options(-U__cpp_concepts -D__cpp_concepts=202002L -Wno-builtin-macro-redefined)
endif()

# Contraction into fused multiply-adds would make results depend on the processor; simulation has to
# be repeatable to the bit.
add_compile_options(-ffp-contract=off)

if(CNC_SANITIZE)
  add_compile_options(-fsanitize=${CNC_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CNC_SANITIZE})
  # gcc 12 believes it of <regex> when a sanitizer is in between; clang does not know it.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-error=maybe-uninitialized)
  endif()
endif()

# Coverage feedback must come from the libraries, not only from the fuzz harness.
if(CNC_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
