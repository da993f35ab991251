# The code that judges cases belongs to the program; its test compiles it, too.
target_sources(test_hardcases PRIVATE
    ${PROJECT_SOURCE_DIR}/app/hardcases/hard_case.cpp ${PROJECT_SOURCE_DIR}/app/hardcases/run_cases.cpp
    ${PROJECT_SOURCE_DIR}/app/hardcases/selection.cpp ${PROJECT_SOURCE_DIR}/app/hardcases/verdict.cpp)
# The catalogue itself; the long version is for `ctest -C Full -L full`.
set(TALBOT_CASE_SCENES ${CMAKE_CURRENT_BINARY_DIR}/case_scenes)
add_test(NAME hardcases_quick COMMAND talbot hardcases --quick --save-scenes ${TALBOT_CASE_SCENES})
add_test(NAME hardcases_full CONFIGURATIONS Full COMMAND talbot hardcases --full)
set_tests_properties(hardcases_quick PROPERTIES TIMEOUT 900)
set_tests_properties(hardcases_full PROPERTIES LABELS full TIMEOUT 14400)
# The scenes that the quick run writes are read again.
target_compile_definitions(test_hardcase_scenes PRIVATE TALBOT_CASE_SCENES="${TALBOT_CASE_SCENES}")
set_tests_properties(hardcases_quick PROPERTIES FIXTURES_SETUP case_scenes)
set_tests_properties(hardcase_scenes PROPERTIES FIXTURES_REQUIRED case_scenes)
