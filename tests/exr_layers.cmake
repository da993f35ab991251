# Reads layers back with the library itself.
pkg_check_modules(TALBOT_TEST_OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
target_link_libraries(test_exr_layers PRIVATE PkgConfig::TALBOT_TEST_OPENEXR)
# Whose flags are not those that the headers of the tests are precompiled with.
set_target_properties(test_exr_layers PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
