# Several sources have fixtures of one name.
set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 8)
# Replaces operator new.
set_source_files_properties(system/allocations.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
# The tape at every instruction set, where the processor has it.
foreach(level IN LISTS EXTREMAL_LEVELS)
  add_test(NAME system.tape.${level} COMMAND ${target} --gtest_filter=Tape.*:*EverySystem*)
  set_tests_properties(system.tape.${level} PROPERTIES ENVIRONMENT EXTREMAL_SIMD=${level}
                       SKIP_REGULAR_EXPRESSION "this processor has")
endforeach()
