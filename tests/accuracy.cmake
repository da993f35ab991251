# The command `talbot accuracy` from outside.
add_test(NAME accuracy_command COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/check_accuracy.py
    $<TARGET_FILE:talbot> ${PROJECT_SOURCE_DIR})
set_tests_properties(accuracy_command PROPERTIES TIMEOUT 300)
