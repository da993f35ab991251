# The real window under a virtual X server; and scripts through --interact.
find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND AND TARGET talbot_ui)
    add_test(NAME viewer_window COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/viewer_window.py
        $<TARGET_FILE:talbot> ${PROJECT_SOURCE_DIR}/assets/scenes/cornell.gltf)
    add_test(NAME viewer_interact COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/viewer_interact.py
        $<TARGET_FILE:talbot> ${PROJECT_SOURCE_DIR}/assets/scenes)
    set_tests_properties(viewer_window viewer_interact PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300
        ENVIRONMENT "TSAN_OPTIONS=suppressions=${CMAKE_CURRENT_SOURCE_DIR}/tsan.supp")
else()
    message(WARNING "Python 3 was not found: the tests of the window are left out")
endif()
