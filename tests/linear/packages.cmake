# Replaces operator new.
set_source_files_properties(linear/allocation_test.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
