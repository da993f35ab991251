# Compiler flags shared by every target: warnings as errors, and floating point that means what the source says
# (no contraction, no fast-math), so that the same samples give the same bytes on every instruction set.
add_library(talbot_flags INTERFACE)
target_compile_options(talbot_flags INTERFACE
    -Wall -Wextra -Wconversion -Wshadow -Werror
    -ffp-contract=off -fno-math-errno -fno-trapping-math
    # From -O2 on g++ makes vectors of straight code, and before 13 it then folds double to float to double into nothing: it
    # compares the precision of the vectors' types, not of their elements.
    $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>
    # clang++ asks std::array for braces that C++ does not.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-missing-braces>)
target_include_directories(talbot_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(talbot_flags INTERFACE TALBOT_VERSION="${PROJECT_VERSION}")
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    target_compile_definitions(talbot_flags INTERFACE TALBOT_CHECKS=1)
endif()
if(TALBOT_SANITIZE)
    # At -O2 the checks take several times as long to compile as they save when they run.
    target_compile_options(talbot_flags INTERFACE -O1 -g1
        -fsanitize=${TALBOT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(talbot_flags INTERFACE -fsanitize=${TALBOT_SANITIZE})
    target_compile_definitions(talbot_flags INTERFACE TALBOT_CHECKS=1)
endif()
