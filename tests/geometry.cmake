# The long versions of the watertight and identity tests: run with `ctest -C Full -L full`.
foreach(name geometry_watertight geometry_bvh geometry_triangle geometry_slabs geometry_self_hits)
    add_test(NAME ${name}_full CONFIGURATIONS Full COMMAND test_${name})
    set_tests_properties(${name}_full PROPERTIES LABELS full TIMEOUT 14400 ENVIRONMENT "TALBOT_TEST_SCALE=200")
endforeach()
