# Reading headers and compiling the same templates again was most of a clean build: sources of one library are compiled several
# at a time. Each stands on its own includes all the same: switch this off to work on single files.
option(TALBOT_UNITY "Compile several sources at a time" ON)

function(talbot_unity target)
    if(TALBOT_UNITY)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
        # It takes a source inside another one for a header.
        target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    endif()
endfunction()
