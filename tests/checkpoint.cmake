# The long version of the kill test: run with `ctest -C Full -L full`.
add_test(NAME checkpoint_full CONFIGURATIONS Full COMMAND test_checkpoint --gtest_filter=*Kills*)
set_tests_properties(checkpoint_full PROPERTIES LABELS full TIMEOUT 900 ENVIRONMENT TALBOT_KILLS=50)
