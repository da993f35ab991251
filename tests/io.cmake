# Encoders, to make compressed input.
target_link_libraries(test_io_gltf_meshopt PRIVATE ${TALBOT_MESHOPTIMIZER})
target_link_libraries(test_io_gltf_draco PRIVATE ${TALBOT_DRACO_LIBRARIES})
target_link_libraries(test_io_gltf_textures PRIVATE ${TALBOT_WEBP_LIBRARIES})

# Fuzz targets, only on request.
option(TALBOT_FUZZ "Build the libFuzzer targets (needs clang; see tests/fuzz/CMakeLists.txt)" OFF)
if(TALBOT_FUZZ)
    add_subdirectory(fuzz)
endif()
