# Reading the same headers again is half of compiling a small source: they are read once a target, in front of every source. Those
# of templates at length cost optimised sources that do not use them more than they save: name them for -O0 alone. Each source
# names its own includes all the same. ccache would key every object by the checkout that the precompiled headers lie in, so this
# is off where it serves; and it is tried out with g++.
if(TALBOT_CCACHE OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(TALBOT_PRECOMPILE_DEFAULT OFF)
else()
    set(TALBOT_PRECOMPILE_DEFAULT ON)
endif()
option(TALBOT_PRECOMPILE "Precompile the headers of other libraries" ${TALBOT_PRECOMPILE_DEFAULT})

set(TALBOT_STANDARD_HEADERS <algorithm> <array> <bit> <chrono> <cmath> <cstdint> <cstdio> <filesystem> <functional> <limits> <map>
    <memory> <mutex> <numbers> <optional> <set> <span> <string> <utility> <vector>)

# The standard library's headers and those named, for every source of the target whose flags are the target's own.
function(talbot_precompile target)
    if(TALBOT_PRECOMPILE)
        target_precompile_headers(${target} PRIVATE ${TALBOT_STANDARD_HEADERS} ${ARGN})
    endif()
endfunction()

# The same file as another target of the same flags.
function(talbot_reuse_precompiled target other)
    if(TALBOT_PRECOMPILE)
        target_precompile_headers(${target} REUSE_FROM ${other})
        # Where flags differ after all the headers are read as ever.
        target_compile_options(${target} PRIVATE -Wno-error=invalid-pch)
    endif()
endfunction()
