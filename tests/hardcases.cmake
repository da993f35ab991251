# The code that judges cases belongs to the program; its test compiles it, too.
target_sources(test_hardcases PRIVATE
    ${PROJECT_SOURCE_DIR}/app/hardcases/hard_case.cpp ${PROJECT_SOURCE_DIR}/app/hardcases/run_cases.cpp
    ${PROJECT_SOURCE_DIR}/app/hardcases/selection.cpp ${PROJECT_SOURCE_DIR}/app/hardcases/verdict.cpp)
# The catalogue itself; the long version is for `ctest -C Full -L full`.
add_test(NAME hardcases_quick COMMAND talbot hardcases --quick)
add_test(NAME hardcases_full CONFIGURATIONS Full COMMAND talbot hardcases --full)
set_tests_properties(hardcases_quick PROPERTIES TIMEOUT 900)
set_tests_properties(hardcases_full PROPERTIES LABELS full TIMEOUT 14400)
