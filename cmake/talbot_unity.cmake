# Reading the same headers again is more than half of compiling small sources: several of them are compiled at a
# time. Each stands on its own includes, and needs a namespace of its own, all the same. Switch this off to work on single files.
option(TALBOT_UNITY "Compile several small sources at a time" ON)

function(talbot_unity target)
    if(TALBOT_UNITY)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    endif()
endfunction()
