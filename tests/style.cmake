# The house rules that a machine can check: include directions, file lengths, no tolerance outside core/math/robust.
add_test(NAME style COMMAND ${CMAKE_COMMAND} -E env python3 ${PROJECT_SOURCE_DIR}/tests/check_style.py ${PROJECT_SOURCE_DIR})
add_test(NAME built_in_scenes COMMAND python3 ${PROJECT_SOURCE_DIR}/assets/generate.py --verify)
# Other versions of clang-format break lines elsewhere.
add_test(NAME format COMMAND python3 ${PROJECT_SOURCE_DIR}/tests/check_format.py ${PROJECT_SOURCE_DIR})
set_tests_properties(format PROPERTIES SKIP_RETURN_CODE 77)
