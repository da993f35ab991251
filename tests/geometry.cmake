# The long versions of the watertight and identity tests, up to 1e8 rays: run with `ctest -C Full -L slow`.
foreach(name geometry_watertight geometry_bvh geometry_triangle geometry_slabs geometry_self_hits geometry_cuts geometry_beams
        geometry_long_double)
    add_test(NAME ${name}_full CONFIGURATIONS Full COMMAND test_${name})
    set_tests_properties(${name}_full PROPERTIES LABELS "full;slow" TIMEOUT 14400 ENVIRONMENT "TALBOT_TEST_SCALE=200")
endforeach()
