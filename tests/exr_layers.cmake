# Reads layers back with the library itself.
pkg_check_modules(TALBOT_TEST_OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
target_link_libraries(test_exr_layers PRIVATE PkgConfig::TALBOT_TEST_OPENEXR)
